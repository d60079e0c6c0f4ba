// The two pictures of the study.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "law/contact_study/study.hpp"

namespace asperity::contact_study {

/// The force on the probe along one slide, |F| in N.
struct trace {
  std::string pair;
  std::uint64_t pose = 0;  ///< the seeded pose that it starts from
  std::vector<double> way_mm, least_motion_n, window_n;
};

/// A slide at 10 kHz. Of the first nine seeded poses, the one at which the paper's formulation has its median jump.
[[nodiscard]] trace trace_slide(const std::string& pair, pair_of_renderers& renderers, std::uint64_t seed);

/// @return io_failed
[[nodiscard]] result<void> draw_traces(const std::vector<trace>& traces, const std::filesystem::path& file);

/// The spectra of uniform_slide(). @return io_failed; what make_renderer() refuses
[[nodiscard]] result<void> draw_spectra(const std::filesystem::path& file);

}  // namespace asperity::contact_study
