#include "support/built_depth.hpp"

#include <utility>

#include "asperity/window/cpu_depth.hpp"

namespace asperity::test_support {

built_depth::built_depth(scene bodies, const depth_settings& settings)
    : made_(std::make_unique<cpu_depth>(std::move(bodies), settings)) {}
built_depth::built_depth(built_depth&&) noexcept = default;
built_depth::~built_depth() = default;

status built_depth::measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept {
  return made_->measure(at, contacts, out);
}

}  // namespace asperity::test_support
