#include "asperity/window/convex_piece_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "window/close_pair.hpp"
#include "window/clustering.hpp"
#include "window/collision_body.hpp"
#include "window/contact_builder.hpp"
#include "window/held_contact.hpp"

namespace asperity {

class convex_piece_finder::search {
 public:
  search(const scene& s, const window_finder_settings& settings) : probe_(s.probe) {
    for (const model_ptr& m : s.fixed) sides_.emplace_back(probe_, m, settings);
  }

  status find(const scene_pose& at, contact_set& out) noexcept {
    out.clear();
    statistics_ = {};
    if (at.T_wb.size() != sides_.size()) return status::not_ready;
    if (!is_valid(at.T_wa) || !std::all_of(at.T_wb.begin(), at.T_wb.end(), is_valid)) return status::invalid_pose;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      find_pairs(sides_[i], inverse(at.T_wa) * at.T_wb[i]);
      if (!sides_[i].clustering.build(sides_[i].pairs, std::cos(sides_[i].settings.merge_angle_rad))) {
        statistics_.dropped_clusters += sides_[i].clustering.left_out();
      }
      identify(sides_[i], at.T_wa, at.T_wb[i]);
      report(sides_[i], static_cast<std::uint32_t>(i), at.T_wa, at.T_wb[i], out);
    }
    const bool complete = statistics_.dropped_pairs == 0 && statistics_.dropped_clusters == 0 && out.dropped() == 0;
    return complete ? status::ok : status::capacity_reached;
  }

  [[nodiscard]] const finder_statistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] const window_finder_settings& settings(std::size_t body) const noexcept {
    return sides_[body].settings;
  }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(probe_, sides_); }

 private:
  /// A cached simplex and the pair it belongs to. Pairs share slots: losing one costs a cold start.
  struct cache_slot {
    std::uint32_t a = 0, b = 0;
    gjk_cache simplex;
  };

  /// A contact of the last tick, to know it again.
  struct track {
    std::uint32_t id = 0;
    std::uint32_t cluster = 0;
    vec3 place_w{0.0};
    vec3 n_ab_w{0.0};
    vec3 u_w{0.0};
    double reach_m = 0.0;
    bool held = false;
    held_contact kept;  ///< what would be held
  };
  static constexpr auto unknown = std::numeric_limits<std::uint32_t>::max();
  static constexpr double same_direction = 0.5;  // 60 degrees

  /// Everything between the probe and one fixed body.
  struct side {
    collision_body body;
    window_finder_settings settings;
    std::vector<cache_slot> cache;
    std::vector<close_pair> pairs;
    pair_clustering clustering;
    contact_builder builder;
    std::vector<track> previous, current;

    side(const collision_body& probe, const model_ptr& m, const window_finder_settings& s)
        : body(m),
          settings(resolve(s, *probe.model, *m)),
          cache(slots(probe.shapes.size() * body.shapes.size())),
          clustering(settings.close_pairs, settings.clusters),
          builder(probe.model->mesh.triangles.size(), m->mesh.triangles.size()) {
      detail::reserve_resident(pairs, settings.close_pairs);
      // Held contacts come on top of the clusters.
      detail::reserve_resident(previous, 2 * settings.clusters);
      detail::reserve_resident(current, 2 * settings.clusters);
    }

    [[nodiscard]] std::size_t heap_bytes() const noexcept {
      return asperity::heap_bytes(body, cache, pairs, clustering, builder, previous, current);
    }

    static std::size_t slots(std::size_t pairs) noexcept {
      constexpr std::size_t most = std::size_t{1} << 16;
      std::size_t n = 1;
      while (n < pairs && n < most) n *= 2;
      return n;
    }
    cache_slot& slot(std::uint32_t a, std::uint32_t b) noexcept {
      const std::size_t n = std::size_t{b} * 2654435761U + a;
      cache_slot& s = cache[n & (cache.size() - 1)];
      if (s.a != a || s.b != b) s = {a, b, {}};
      return s;
    }
  };

  /// Close pairs of pieces. Where hulls overlap, surfaces may have passed each other by more than the tolerance: then,
  /// and only then, a second pass looks for such pairs as far as the depth limit.
  void find_pairs(side& s, const pose& T) noexcept {
    const placement T_ab(T);
    const std::size_t overlapping = statistics_.penetrating_pairs;
    s.pairs.clear();
    visit_candidates(s, T_ab, {-1.0, s.settings.tolerance_m});
    if (statistics_.penetrating_pairs == overlapping || s.settings.max_depth_m <= s.settings.tolerance_m) return;
    const std::size_t near = statistics_.close_pairs;
    visit_candidates(s, T_ab, {s.settings.tolerance_m, s.settings.max_depth_m});
    statistics_.deep_pairs += statistics_.close_pairs - near;
  }

  void visit_candidates(side& s, const placement& T_ab, const distance_shell& shell) noexcept {
    const narrow_phase_limits limits{s.settings.tolerance_m, s.settings.max_depth_m};
    const double margin = shell.outer_m;
    const mat3 size(glm::abs(T_ab.rotation[0]), glm::abs(T_ab.rotation[1]), glm::abs(T_ab.rotation[2]));
    for (std::uint32_t j = 0; j < s.body.shapes.size(); ++j) {
      const convex_shape& B = s.body.shapes[j];
      const vec3 centre = T_ab * B.centre;
      const vec3 extent = size * (0.5 * (B.box.high - B.box.low));
      const bounds box_b{centre - extent, centre + extent};
      probe_.piece_tree.query({box_b.low - margin, box_b.high + margin}, [&](std::uint32_t i) {
        const convex_shape& A = probe_.shapes[i];
        const vec3 apart = centre - A.centre;
        const double reach = A.radius + B.radius + margin;
        if (glm::dot(apart, apart) > reach * reach) return;
        if (shell.deep() && !may_have_passed(A, B, T_ab)) return;
        ++statistics_.candidate_pairs;
        close_pair pair;
        pair.a = i;
        pair.b = j;
        narrow_phase_cost cost;
        evaluate_pair(A, B, T_ab, limits, shell, s.slot(i, j).simplex, pair, cost);
        statistics_.gjk_iterations = std::max(statistics_.gjk_iterations, cost.gjk_iterations);
        if (cost.overlapping) ++statistics_.penetrating_pairs;
        if (pair.kind == pair_kind::apart) return;
        const vec3 low = glm::max(A.box.low, box_b.low);
        const vec3 high = glm::min(A.box.high, box_b.high);
        pair.region = {glm::min(low, high) - 0.5 * limits.tolerance_m, glm::max(low, high) + 0.5 * limits.tolerance_m};
        add_pair(s, pair);
      });
    }
  }

  void add_pair(side& s, const close_pair& pair) noexcept {
    ++statistics_.close_pairs;
    if (pair.kind == pair_kind::passive) ++statistics_.passive_pairs;
    if (s.pairs.size() == s.settings.close_pairs) {
      ++statistics_.dropped_pairs;
    } else {
      s.pairs.push_back(pair);
    }
  }

  [[nodiscard]] static const close_pair& deepest_pair(const side& s, const pair_cluster& c) noexcept {
    const close_pair* deepest = nullptr;
    for (const std::uint32_t m : s.clustering.members(c).first(c.active)) {
      if (deepest == nullptr || s.pairs[m].separation_m < deepest->separation_m) deepest = &s.pairs[m];
    }
    return *deepest;  // a cluster has at least its seed
  }

  /// True where a cluster of this tick may be the contact `old` of the last one.
  [[nodiscard]] static bool may_be(const track& now, const track& old) noexcept {
    return glm::distance(now.place_w, old.place_w) <= old.reach_m && glm::dot(now.n_ab_w, old.n_ab_w) >= same_direction;
  }

  /// Decides whether a contact of the last tick is held in this one. A contact is held from where its deepest pair is
  /// deeper than the limit, until a pair has a valid direction there again, the surfaces have parted along the held
  /// direction, or the probe has left the body on the far side. A contact that moved further than across its window is
  /// not the same one.
  [[nodiscard]] bool is_to_hold(const side& s, const track& old, const pose& T_wa, const pose& T_wb) const noexcept {
    if (!old.kept.valid() || old.kept.moved_m(T_wa, T_wb) > old.reach_m) return false;
    if (has_passed_through(probe_.model->box, s.body.model->box, old.n_ab_w, T_wa, T_wb)) return false;
    if (old.kept.depth_m(T_wa, T_wb) > s.settings.max_depth_m) return true;
    if (!old.held || old.kept.separation_m(T_wa, T_wb) > s.settings.tolerance_m) return false;
    return std::none_of(s.current.begin(), s.current.end(), [&](const track& now) { return may_be(now, old); });
  }

  /// Gives every cluster the id and axes of the contact that was nearest to it in the last tick, or new ones. Clusters
  /// that belong to a held contact are part of it. While one is held, a cluster that comes up deep inside is the way
  /// out on another side: it is left out.
  void identify(side& s, const pose& T_wa, const pose& T_wb) noexcept {
    const auto clusters = s.clustering.clusters();
    std::swap(s.previous, s.current);
    s.current.clear();
    for (std::uint32_t i = 0; i < clusters.size(); ++i) {
      track now;
      now.id = unknown;
      now.cluster = i;
      now.place_w = T_wa * clusters[i].place;
      now.n_ab_w = T_wa.rotation * clusters[i].n_ab;
      s.current.push_back(now);
    }
    bool holding = false;
    for (track& old : s.previous) {
      if (old.held || old.kept.valid()) {
        const track moved = carried(old, T_wa, T_wb);
        const bool hold = is_to_hold(s, moved, T_wa, T_wb);
        if (hold || old.held) old = moved;
        old.held = hold;
        holding = holding || hold;
      }
    }
    match(s);
    if (holding) {
      std::erase_if(s.current, [&](const track& now) {
        const bool left_out =
            now.id == unknown && -deepest_pair(s, clusters[now.cluster]).separation_m > s.settings.tolerance_m;
        if (left_out) ++statistics_.unheld_clusters;
        return left_out;
      });
      for (const track& old : s.previous) {
        if (!old.held) continue;
        if (s.current.size() == 2 * s.settings.clusters) {
          ++statistics_.dropped_clusters;
        } else {
          s.current.push_back(old);
        }
      }
    }
    for (track& now : s.current) {
      if (now.id == unknown) now.id = next_id_++;
      const vec3 u = now.u_w - glm::dot(now.u_w, now.n_ab_w) * now.n_ab_w;
      const double length = std::sqrt(glm::dot(u, u));
      now.u_w = length > 1e-3 ? u / length : any_orthogonal(now.n_ab_w);
    }
    std::sort(s.current.begin(), s.current.end(), [](const track& x, const track& y) { return x.id < y.id; });
  }

  /// A track whose place and direction went with its bodies since the last tick.
  [[nodiscard]] static track carried(track old, const pose& T_wa, const pose& T_wb) noexcept {
    old.place_w = T_wa * old.kept.p_a;
    old.n_ab_w = old.kept.n_ab_w(T_wb);
    return old;
  }

  /// Nearest first: a contact of the last tick hands its id on once; a held one takes in every cluster that it is
  /// nearest to.
  static void match(side& s) noexcept {
    for (;;) {
      std::size_t best = 0, best_old = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < s.current.size(); ++i) {
        const track& now = s.current[i];
        if (now.id != unknown) continue;
        for (std::size_t k = 0; k < s.previous.size(); ++k) {
          const double distance = glm::distance(now.place_w, s.previous[k].place_w);
          if (distance >= nearest || !may_be(now, s.previous[k])) continue;
          best = i;
          best_old = k;
          nearest = distance;
        }
      }
      if (nearest == std::numeric_limits<double>::infinity()) return;
      if (s.previous[best_old].held) {
        s.current.erase(s.current.begin() + static_cast<std::ptrdiff_t>(best));
        continue;
      }
      s.current[best].id = s.previous[best_old].id;
      s.current[best].u_w = s.previous[best_old].u_w;
      s.previous.erase(s.previous.begin() + static_cast<std::ptrdiff_t>(best_old));
    }
  }

  void report(side& s, std::uint32_t body, const pose& T_wa, const pose& T_wb, contact_set& out) noexcept {
    for (track& now : s.current) {
      contact c;
      c.body = body;
      c.id = now.id;
      c.window.u_w = now.u_w;
      c.held = now.held;
      if (!build(s, now, T_wa, T_wb, c)) {
        now.kept = {};
        now.held = false;
        ++statistics_.empty_clusters;
        continue;
      }
      // A contact that moved no further than across its window is the same one.
      now.reach_m = 2.0 * c.window.half_size_m + s.settings.tolerance_m;
      if (now.held) ++statistics_.held_contacts;
      (void)out.add(c, s.builder.patch_a(), s.builder.patch_b());  // a refusal is counted in out.dropped()
    }
  }

  [[nodiscard]] bool build(side& s, track& now, const pose& T_wa, const pose& T_wb, contact& c) noexcept {
    if (now.held) {
      now.kept.last_b = inverse(T_wb) * (T_wa * now.kept.p_a);
      return s.builder.build(probe_, s.body, T_wa, T_wb, s.settings, now.kept, c);
    }
    const pair_cluster& cluster = s.clustering.clusters()[now.cluster];
    if (!s.builder.build(probe_, s.body, T_wa, T_wb, s.settings, s.pairs, s.clustering.members(cluster), cluster, c)) {
      return false;
    }
    now.kept = keep_contact(c, cluster, deepest_pair(s, cluster), s.builder.near(), T_wa, T_wb);
    return true;
  }

  collision_body probe_;
  std::vector<side> sides_;
  std::uint32_t next_id_ = 0;
  finder_statistics statistics_;
};

convex_piece_finder::convex_piece_finder(const scene& s, const window_finder_settings& settings)
    : search_(std::make_unique<search>(s, settings)) {}
convex_piece_finder::convex_piece_finder(convex_piece_finder&&) noexcept = default;
convex_piece_finder& convex_piece_finder::operator=(convex_piece_finder&&) noexcept = default;
convex_piece_finder::~convex_piece_finder() = default;

status convex_piece_finder::find(const scene_pose& at, contact_set& out) noexcept { return search_->find(at, out); }
const finder_statistics& convex_piece_finder::statistics() const noexcept { return search_->statistics(); }
const window_finder_settings& convex_piece_finder::settings(std::size_t body) const noexcept {
  return search_->settings(body);
}
std::size_t convex_piece_finder::heap_bytes() const noexcept { return sizeof(search) + search_->heap_bytes(); }

}  // namespace asperity
