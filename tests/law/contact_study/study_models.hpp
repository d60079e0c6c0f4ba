// The pairs of bodies that are studied, and where they come from.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"

namespace asperity::contact_study {

struct pair_name {
  std::string_view probe, fixed;
};

/// The first three are pairs of benchmark models; the last needs real meshes.
inline constexpr std::array<pair_name, 4> all_pairs{
    {{"block", "gear"}, {"file", "cad_part"}, {"hammer", "torus"}, {"igea", "rocker-arm"}}};

/// A baked model of that name.
///
/// Taken from `baked`, a folder of models as the tests keep it, and from `kept` otherwise. What neither has is made and
/// kept there: a benchmark model from its formulas, a real mesh from the folder that ASPERITY_MODELS names, or
/// shared/models beside the checkout. Real meshes have no unit; they are scaled to a diagonal of 160 mm.
/// @return io_failed where there is no such mesh; what a bake refuses
[[nodiscard]] result<model_ptr> study_model(std::string_view name, const std::filesystem::path& baked,
                                            const std::filesystem::path& kept);

}  // namespace asperity::contact_study
