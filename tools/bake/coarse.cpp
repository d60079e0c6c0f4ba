#include "bake/coarse.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "bake/cage.hpp"
#include "bake/geometry.hpp"
#include "bake/relief_fit.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {
namespace {

// A count is tried once for all attempts of simplify(): each takes some seconds on half a million triangles.
constexpr int most_counts = 5;
constexpr std::size_t most_coarse_triangles = 50'000;
constexpr double room_over_stuck = 1.1;  // to what the topology left, so that no triangle need be a sliver
constexpr std::size_t count_step = 100;

error bake_cancelled() { return {error_code::cancelled, "the bake was cancelled"}; }

result<simplified_mesh> made_or_given(const checked_mesh& full, const bake_settings& settings, std::size_t triangles,
                                      unsigned threads, stage_monitor& monitor, std::size_t& stuck_at) {
  if (!settings.coarse) return simplify(full, triangles, threads, monitor, &stuck_at);
  triangle_mesh rounded = *settings.coarse;
  round_to_float32(rounded);
  auto given = check(rounded, "the coarse mesh");
  if (!given) return given.error();
  simplified_mesh out{std::move(given->mesh), {}};
  if (given->flipped) out.note = "the coarse mesh was inside-out and has been turned";
  if (given->turned_triangles > 0) {
    const std::string turned = "of the coarse mesh " + winding_remark(given->turned_triangles);
    out.note = out.note.empty() ? turned : out.note + "; " + turned;
  }
  return out;
}

result<coarse_choice> with_count(const checked_mesh& full, const bake_settings& settings, std::size_t triangles,
                                 unsigned threads, stage_monitor& monitor, std::size_t& stuck_at) {
  stuck_at = 0;
  if (!monitor.begin("simplify")) return bake_cancelled();
  auto made = made_or_given(full, settings, triangles, threads, monitor, stuck_at);
  if (!made) return made.error();
  // Only now: simplifying is what takes the most memory.
  triangle_bvh tree(full.mesh.positions, full.mesh.triangles, threads, &monitor);
  if (monitor.cancelled()) return bake_cancelled();
  if (!settings.coarse && made->mesh.triangles.size() < full.mesh.triangles.size())
    fit_to_relief(made->mesh, tree, widest_cage_in_diagonals * bounds_of(full.mesh.positions).diagonal(), threads,
                  &monitor);
  if (monitor.cancelled()) return bake_cancelled();
  if (!monitor.begin("compare")) return bake_cancelled();
  const auto cage = measure_cage(full.mesh, tree, made->mesh, threads, monitor);
  if (!cage) return cage.error();
  return coarse_choice{std::move(*made), std::move(tree), *cage};
}

// The sentence without its mend.
std::string fault_of(const error& refusal) { return refusal.message.substr(0, refusal.message.rfind("; ")); }

}  // namespace

result<coarse_choice> choose_coarse(const checked_mesh& full, const bake_settings& settings, unsigned threads,
                                    stage_monitor& monitor) {
  std::size_t stuck_at = 0;
  result<coarse_choice> asked = with_count(full, settings, settings.triangles, threads, monitor, stuck_at);
  if (asked || settings.coarse || asked.error().code != error_code::bad_mesh) return asked;
  std::size_t count = settings.triangles, tried = count;
  for (int i = 0; i < most_counts; ++i) {
    const auto over_stuck = static_cast<std::size_t>(std::ceil(room_over_stuck * static_cast<double>(stuck_at)));
    count = (std::max(2 * count, over_stuck) + count_step - 1) / count_step * count_step;
    if (count > most_coarse_triangles) break;
    tried = count;
    result<coarse_choice> more = with_count(full, settings, count, threads, monitor, stuck_at);
    if (!more && more.error().code != error_code::bad_mesh) return more;
    if (!more) continue;
    if (!settings.more_triangles)
      return error{error_code::bad_mesh,
                   fault_of(asked.error()) + "; ask for " + std::to_string(count) + " triangles, which are enough"};
    std::string& note = more->made.note;
    const std::string why = "the coarse mesh was given " + std::to_string(count) + " triangles instead of " +
                            std::to_string(settings.triangles) + ": " + fault_of(asked.error());
    note = note.empty() ? why : why + "; " + note;
    return more;
  }
  if (tried == settings.triangles) return asked;
  return error{error_code::bad_mesh,
               fault_of(asked.error()) + ", nor with up to " + std::to_string(tried) + "; give a coarse mesh"};
}

}  // namespace asperity::bake
