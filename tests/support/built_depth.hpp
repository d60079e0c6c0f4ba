// The depth backends on the CPU, compiled once for all tests and optimised as for a user: what a test measures with
// them takes longer than anything else that it does. A test of the backends themselves includes those instead.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "asperity/render/depth_backend.hpp"
#include "asperity/window/depth_settings.hpp"

namespace asperity {
class cpu_depth;
}  // namespace asperity

namespace asperity::test_support {

/// A cpu_depth that is somewhere else; see there.
class built_depth {
 public:
  using policy_tag = depth_tag;

  explicit built_depth(scene bodies, const depth_settings& settings = {});
  built_depth(built_depth&&) noexcept;
  ~built_depth();

  [[nodiscard]] status measure(const scene_pose& at, const contact_set& contacts, std::span<penetration> out) noexcept;

 private:
  std::unique_ptr<cpu_depth> made_;
};

static_assert(depth_backend<built_depth>);

}  // namespace asperity::test_support
