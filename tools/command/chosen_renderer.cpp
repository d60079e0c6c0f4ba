#include "chosen_renderer.hpp"

#include <utility>
#include <variant>

#include "asperity/render/default_renderer.hpp"

namespace asperity::command {

struct chosen_renderer::either {
  template <class R>
  explicit either(R chosen) : of(std::move(chosen)) {}

  std::variant<renderer, paper_renderer> of;
};

chosen_renderer::chosen_renderer(std::unique_ptr<either> chosen) noexcept : either_(std::move(chosen)) {}
chosen_renderer::chosen_renderer(chosen_renderer&&) noexcept = default;
chosen_renderer& chosen_renderer::operator=(chosen_renderer&&) noexcept = default;
chosen_renderer::~chosen_renderer() = default;

status chosen_renderer::step(const scene_pose& at, tick& out) noexcept {
  if (auto* const shared = std::get_if<renderer>(&either_->of)) return shared->step(at, out);
  return std::get_if<paper_renderer>(&either_->of)->step(at, out);
}

const asperity::scene& chosen_renderer::scene() const noexcept {
  if (const auto* const shared = std::get_if<renderer>(&either_->of)) return shared->scene();
  return std::get_if<paper_renderer>(&either_->of)->scene();
}

std::size_t chosen_renderer::memory_bytes() const noexcept {
  if (const auto* const shared = std::get_if<renderer>(&either_->of)) return shared->memory_bytes();
  return std::get_if<paper_renderer>(&either_->of)->memory_bytes();
}

result<void> check(const render_options& options) {
  if (options.backend != "cpu") {
    return error{error_code::unsupported,
                 "the depth backend " + options.backend + " is not part of this build: use --backend cpu"};
  }
  if (options.contacts == "shared" && (options.gradient || options.grid)) {
    return error{error_code::invalid_argument, std::string(options.gradient ? "--gradient" : "--grid") +
                                                   " belongs to the paper's contacts: add --contacts paper"};
  }
  return {};
}

result<chosen_renderer> make_chosen_renderer(asperity::scene bodies, const render_options& options) {
  if (const result<void> ok = check(options); !ok) return ok.error();
  const auto chosen = [](auto made) -> result<chosen_renderer> {
    if (!made) return made.error();
    return chosen_renderer(std::make_unique<chosen_renderer::either>(std::move(made).value()));
  };
  if (options.contacts == "shared") return chosen(make_renderer(std::move(bodies)));
  paper_settings settings;
  settings.depth.gradient =
      options.gradient.value_or("soft") == "central" ? gradient_scheme::central_difference : gradient_scheme::soft_max;
  if (options.grid) settings.depth.grid = *options.grid;
  return chosen(make_paper_renderer(std::move(bodies), settings));
}

}  // namespace asperity::command
