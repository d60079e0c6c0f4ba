// The renderers that the command offers. Each is made in a file of its own, which compiles its ticks.
#pragma once

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "chosen_renderer.hpp"
#include "render_choice.hpp"

namespace asperity::command {

using renderer_maker = result<chosen_renderer>(scene bodies, const render_options& options);

renderer_maker make_shared_on_cpu;     // shared_on_cpu.cpp
renderer_maker make_field_on_cpu;      // field_on_cpu.cpp
renderer_maker make_paper_on_cpu;      // paper_on_cpu.cpp
renderer_maker make_paper_with_exact;  // paper_with_exact.cpp
// In builds with OpenGL, where ASPERITY_HAS_GL is defined:
renderer_maker make_paper_with_gl_compute;    // paper_with_gl_compute.cpp
renderer_maker make_paper_with_gl_occlusion;  // paper_with_gl_occlusion.cpp

}  // namespace asperity::command
