// What a page is told once: which bodies there are, where, and what the numbers of a row mean.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asperity/control/workspace_map.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "view/trace.hpp"

namespace asperity::view {

/// What a page shows.
enum class page_mode : std::uint8_t { live, replay, model, gallery };

/// A body of the scene. The first is the probe, or the first two are where two recordings are compared, but for
/// page_mode::model.
struct shown_body {
  std::string name;
  model_ptr model;
  pose T_w{};
  std::shared_ptr<const triangle_mesh> original{};  ///< what the model was baked from, to colour it by the distance
};

struct page_scene {
  page_mode mode = page_mode::live;
  std::string title;
  std::vector<shown_body> bodies;
  workspace_map map{};
  bool virtual_clock = false;         ///< pages may pause a live session
  bool leads = false;                 ///< pages lead the simulated hand
  std::vector<std::string> listed{};  ///< page_mode::gallery: the names of its models
  double device_period_s = 1e-3;      ///< a tick that takes longer is late
  double most_force_n = 0.0;          ///< of the device; 0: not known
};

/// A recording that a page replays. Where there are two, each has a probe of its own among the first bodies of the scene.
struct shown_recording {
  std::string name;
  std::vector<trace_row> rows;  ///< at least one, in the order of their times

  /// Seconds between two rows, in the mean; 0 for a single one.
  [[nodiscard]] double period_s() const noexcept {
    return rows.size() < 2 ? 0.0 : (rows.back().time_s - rows.front().time_s) / static_cast<double>(rows.size() - 1);
  }
};

/// Everything of a page that does not change while it is open.
struct page_content {
  std::string document;             ///< JSON, see scene_document.cpp
  std::vector<std::string> meshes;  ///< one for each model, see shown_mesh; the document says whose it is
  std::vector<std::string> rows;    ///< of each recording, see append_rows()
};

/// @param recordings none but for page_mode::replay
/// @param most_points of all models together; bodies that share a model share its points
[[nodiscard]] page_content make_content(const page_scene& scene, const std::vector<shown_recording>& recordings,
                                        std::size_t most_points);

/// Rows as bytes: their times as doubles, then their values as floats. What a page reads of a replay and in frames.
void append_rows(std::string& to, const std::vector<trace_row>& rows);

}  // namespace asperity::view
