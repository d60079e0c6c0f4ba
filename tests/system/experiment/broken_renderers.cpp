// The renderer with broken policies, compiled as far optimised as those of the command.
#include "broken_renderers.hpp"

#include <utility>

#include "broken_policies.hpp"

namespace broken {

result<any_renderer> make_renderer(scene bodies, const experiment::variant& kind, mutation how) {
  if (const result<void> ok = command::check(kind.options); !ok) return ok.error();
  result<broken_paper_renderer> made = make_paper(std::move(bodies), command::grid_settings(kind.options), how);
  if (!made) return made.error();
  return any_renderer(std::move(made).value());
}

}  // namespace broken
