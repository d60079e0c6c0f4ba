// The two renderers of default_renderer.hpp, compiled once for all tests. Their ticks take the
// compiler longer than any test that feels with them. A test of the templates themselves includes those instead.
#pragma once

#include <memory>

#include "asperity/least_motion/renderer_settings.hpp"
#include "asperity/render/renderer.hpp"
#include "asperity/window/paper_settings.hpp"

namespace asperity::test_support {

struct default_formulation;
struct papers_formulation;

/// A renderer that is somewhere else; see basic_renderer for what its functions do.
template <class Formulation>
class built {
 public:
  explicit built(std::unique_ptr<Formulation> made) noexcept;
  built(built&&) noexcept;
  built& operator=(built&&) noexcept;
  ~built();

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept;
  [[nodiscard]] const asperity::scene& scene() const noexcept;
  [[nodiscard]] const contact_set& contacts() const noexcept;

 protected:
  std::unique_ptr<Formulation> made_;
};

class built_renderer : public built<default_formulation> {
 public:
  using built::built;

  /// With what was automatic filled in.
  [[nodiscard]] const least_motion_settings& settings() const noexcept;
  /// Of the springs in the last tick.
  [[nodiscard]] double energy_j() const noexcept;
};

using built_paper_renderer = built<papers_formulation>;

/// make_renderer() and make_paper_renderer(). What was made of the last few scenes is kept for those who feel them
/// again.
[[nodiscard]] result<built_renderer> build_renderer(scene bodies, const renderer_settings& settings = {});
[[nodiscard]] result<built_paper_renderer> build_paper_renderer(scene bodies, const paper_settings& settings = {});

}  // namespace asperity::test_support
