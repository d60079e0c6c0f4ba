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
  search(const scene& s, const window_finder_settings& settings)
      : clustering_(settings.close_pairs, settings.clusters), builder_(s.probe->mesh.triangles.size(), triangles(s)) {
    bodies_.reserve(1 + s.fixed.size());
    bodies_.emplace_back(s.probe);
    sides_.reserve(s.fixed.size());
    for (const model_ptr& m : s.fixed) add_side(m, settings);
    bodies_.shrink_to_fit();
    caches_.shrink_to_fit();
    detail::reserve_resident(pairs_, settings.close_pairs);
    detail::reserve_resident(previous_, tracks_of_one(settings));
    detail::reserve_resident(current_, tracks_of_one(settings));
    const std::size_t most_tracks = std::min(sides_.size(), most_touched) * tracks_of_one(settings);
    detail::reserve_resident(tracks_before_, most_tracks);
    detail::reserve_resident(tracks_, most_tracks);
  }

  status find(const scene_pose& at, contact_set& out) noexcept {
    out.clear();
    statistics_ = {};
    if (at.T_wb.size() != sides_.size()) return status::not_ready;
    if (!is_valid(at.T_wa) || !std::all_of(at.T_wb.begin(), at.T_wb.end(), is_valid)) return status::invalid_pose;
    std::swap(tracks_, tracks_before_);
    tracks_.clear();
    const vec3 centre_w = at.T_wa * probe().sphere.centre_b;
    for (std::uint32_t i = 0; i < sides_.size(); ++i) {
      take_tracks_of(i);
      // No pair of pieces is within reach then; what was held in the tick before is still asked about.
      if (previous_.empty() && !within_reach(sides_[i], centre_w, at.T_wb[i])) continue;
      ++statistics_.near_bodies;
      find_in(sides_[i], i, at.T_wa, at.T_wb[i], out);
    }
    const bool complete = statistics_.dropped_pairs == 0 && statistics_.dropped_clusters == 0 && out.dropped() == 0;
    return complete ? status::ok : status::capacity_reached;
  }

  [[nodiscard]] const finder_statistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] const window_finder_settings& settings(std::size_t body) const noexcept {
    return sides_[body].settings;
  }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(bodies_, sides_, caches_, pairs_, clustering_, builder_, previous_, current_,
                                tracks_before_, tracks_);
  }

 private:
  /// A cached simplex and the pair it belongs to. Pairs share slots: losing one costs a cold start.
  struct cache_slot {
    std::uint32_t side = 0, a = 0, b = 0;
    gjk_cache simplex;
  };

  /// A contact of the last tick, to know it again.
  struct track {
    std::uint32_t side = 0;
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

  /// Simplices of the probe against all fixed bodies of one model.
  struct simplex_cache {
    std::vector<cache_slot> slots;

    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(slots); }
  };

  /// What differs from one fixed body to the next: small, because a scene may have many of one model.
  struct side {
    std::uint32_t body = 0;   ///< its model, in bodies_
    std::uint32_t cache = 0;  ///< in caches_
    std::uint32_t among = 0;  ///< how many bodies before it have the same model
    window_finder_settings settings;
  };

  /// Bodies that may be touched in one tick with as many contacts as the settings allow; more share their room.
  static constexpr std::size_t most_touched = 2;

  /// Held contacts come on top of the clusters.
  static constexpr std::size_t tracks_of_one(const window_finder_settings& s) noexcept { return 2 * s.clusters; }

  static std::size_t triangles(const scene& s) noexcept {
    std::size_t most = 0;
    for (const model_ptr& m : s.fixed) most = std::max(most, m->mesh.triangles.size());
    return most;
  }

  static std::size_t slots(std::size_t pairs) noexcept {
    constexpr std::size_t most = std::size_t{1} << 16;
    std::size_t n = 1;
    while (n < pairs && n < most) n *= 2;
    return n;
  }

  void add_side(const model_ptr& m, const window_finder_settings& settings) {
    side out{.settings = resolve(settings, *probe().model, *m)};
    const auto of = [&](const side& s) { return bodies_[s.body].model == m; };
    if (const auto same = std::find_if(sides_.begin(), sides_.end(), of); same != sides_.end()) {
      out.body = same->body;
      out.cache = same->cache;
      out.among = static_cast<std::uint32_t>(std::count_if(sides_.begin(), sides_.end(), of));
    } else {
      if (m != probe().model) {
        out.body = static_cast<std::uint32_t>(bodies_.size());
        bodies_.emplace_back(m);
      }
      out.cache = static_cast<std::uint32_t>(caches_.size());
      caches_.push_back({std::vector<cache_slot>(slots(probe().shapes.size() * bodies_[out.body].shapes.size()))});
    }
    sides_.push_back(out);
  }

  [[nodiscard]] const collision_body& probe() const noexcept { return bodies_.front(); }
  [[nodiscard]] const collision_body& body(const side& s) const noexcept { return bodies_[s.body]; }

  cache_slot& slot(const side& s, std::uint32_t a, std::uint32_t b) noexcept {
    std::vector<cache_slot>& cache = caches_[s.cache].slots;
    const std::size_t n = std::size_t{b} * 2654435761U + a + std::size_t{s.among} * 2246822519U;
    cache_slot& found = cache[n & (cache.size() - 1)];
    if (found.side != s.among || found.a != a || found.b != b) found = {s.among, a, b, {}};
    return found;
  }

  [[nodiscard]] bool within_reach(const side& s, const vec3& probe_centre_w, const pose& T_wb) const noexcept {
    const body_sphere &A = probe().sphere, &B = body(s).sphere;
    return may_be_within(s.settings.tolerance_m, probe_centre_w, A.radius_m, T_wb * B.centre_b, B.radius_m);
  }

  /// The tracks of one side, in the order of the tick before, into previous_.
  void take_tracks_of(std::uint32_t index) noexcept {
    previous_.clear();
    for (const track& t : tracks_before_) {
      if (t.side == index) previous_.push_back(t);
    }
  }

  void find_in(const side& s, std::uint32_t index, const pose& T_wa, const pose& T_wb, contact_set& out) noexcept {
    find_pairs(s, inverse(T_wa) * T_wb);
    if (!clustering_.build(pairs_, std::cos(s.settings.merge_angle_rad))) {
      statistics_.dropped_clusters += clustering_.left_out();
    }
    identify(s, T_wa, T_wb);
    report(s, index, T_wa, T_wb, out);
    for (track& t : current_) {
      t.side = index;
      if (tracks_.size() < tracks_.capacity()) {
        tracks_.push_back(t);
      } else {
        ++statistics_.dropped_clusters;
      }
    }
  }

  /// Close pairs of pieces. Where hulls overlap, surfaces may have passed each other by more than the tolerance: then,
  /// and only then, a second pass looks for such pairs as far as the depth limit.
  void find_pairs(const side& s, const pose& T) noexcept {
    const placement T_ab(T);
    const std::size_t overlapping = statistics_.penetrating_pairs;
    pairs_.clear();
    visit_candidates(s, T_ab, {-1.0, s.settings.tolerance_m});
    if (statistics_.penetrating_pairs == overlapping || s.settings.max_depth_m <= s.settings.tolerance_m) return;
    const std::size_t near = statistics_.close_pairs;
    visit_candidates(s, T_ab, {s.settings.tolerance_m, s.settings.max_depth_m});
    statistics_.deep_pairs += statistics_.close_pairs - near;
  }

  void visit_candidates(const side& s, const placement& T_ab, const distance_shell& shell) noexcept {
    const narrow_phase_limits limits{s.settings.tolerance_m, s.settings.max_depth_m};
    const double margin = shell.outer_m;
    const mat3 size(glm::abs(T_ab.rotation[0]), glm::abs(T_ab.rotation[1]), glm::abs(T_ab.rotation[2]));
    const std::vector<convex_shape>& shapes_b = body(s).shapes;
    for (std::uint32_t j = 0; j < shapes_b.size(); ++j) {
      const convex_shape& B = shapes_b[j];
      const vec3 centre = T_ab * B.centre;
      const vec3 extent = size * (0.5 * (B.box.high - B.box.low));
      const bounds box_b{centre - extent, centre + extent};
      probe().piece_tree.query({box_b.low - margin, box_b.high + margin}, [&](std::uint32_t i) {
        const convex_shape& A = probe().shapes[i];
        const vec3 apart = centre - A.centre;
        const double reach = A.radius + B.radius + margin;
        if (glm::dot(apart, apart) > reach * reach) return;
        if (shell.deep() && !may_have_passed(A, B, T_ab)) return;
        ++statistics_.candidate_pairs;
        close_pair pair;
        pair.a = i;
        pair.b = j;
        narrow_phase_cost cost;
        evaluate_pair(A, B, T_ab, limits, shell, slot(s, i, j).simplex, pair, cost);
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

  void add_pair(const side& s, const close_pair& pair) noexcept {
    ++statistics_.close_pairs;
    if (pair.kind == pair_kind::passive) ++statistics_.passive_pairs;
    if (pairs_.size() == s.settings.close_pairs) {
      ++statistics_.dropped_pairs;
    } else {
      pairs_.push_back(pair);
    }
  }

  [[nodiscard]] const close_pair& deepest_pair(const pair_cluster& c) const noexcept {
    const close_pair* deepest = nullptr;
    for (const std::uint32_t m : clustering_.members(c).first(c.active)) {
      if (deepest == nullptr || pairs_[m].separation_m < deepest->separation_m) deepest = &pairs_[m];
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
    if (has_passed_through(probe().model->box, body(s).model->box, old.n_ab_w, T_wa, T_wb)) return false;
    if (old.kept.depth_m(T_wa, T_wb) > s.settings.max_depth_m) return true;
    if (!old.held || old.kept.separation_m(T_wa, T_wb) > s.settings.tolerance_m) return false;
    return std::none_of(current_.begin(), current_.end(), [&](const track& now) { return may_be(now, old); });
  }

  /// Gives every cluster the id and axes of the contact that was nearest to it in the last tick, or new ones. Clusters
  /// that belong to a held contact are part of it. While one is held, a cluster that comes up deep inside is the way
  /// out on another side: it is left out.
  void identify(const side& s, const pose& T_wa, const pose& T_wb) noexcept {
    const auto clusters = clustering_.clusters();
    current_.clear();
    for (std::uint32_t i = 0; i < clusters.size(); ++i) {
      track now;
      now.id = unknown;
      now.cluster = i;
      now.place_w = T_wa * clusters[i].place;
      now.n_ab_w = T_wa.rotation * clusters[i].n_ab;
      current_.push_back(now);
    }
    bool holding = false;
    for (track& old : previous_) {
      if (old.held || old.kept.valid()) {
        const track moved = carried(old, T_wa, T_wb);
        const bool hold = is_to_hold(s, moved, T_wa, T_wb);
        if (hold || old.held) old = moved;
        old.held = hold;
        holding = holding || hold;
      }
    }
    match();
    if (holding) {
      std::erase_if(current_, [&](const track& now) {
        const bool left_out =
            now.id == unknown && -deepest_pair(clusters[now.cluster]).separation_m > s.settings.tolerance_m;
        if (left_out) ++statistics_.unheld_clusters;
        return left_out;
      });
      for (const track& old : previous_) {
        if (!old.held) continue;
        if (current_.size() == tracks_of_one(s.settings)) {
          ++statistics_.dropped_clusters;
        } else {
          current_.push_back(old);
        }
      }
    }
    for (track& now : current_) {
      if (now.id == unknown) now.id = next_id_++;
      const vec3 u = now.u_w - glm::dot(now.u_w, now.n_ab_w) * now.n_ab_w;
      const double length = std::sqrt(glm::dot(u, u));
      now.u_w = length > 1e-3 ? u / length : any_orthogonal(now.n_ab_w);
    }
    std::sort(current_.begin(), current_.end(), [](const track& x, const track& y) { return x.id < y.id; });
  }

  /// A track whose place and direction went with its bodies since the last tick.
  [[nodiscard]] static track carried(track old, const pose& T_wa, const pose& T_wb) noexcept {
    old.place_w = T_wa * old.kept.p_a;
    old.n_ab_w = old.kept.n_ab_w(T_wb);
    return old;
  }

  /// Nearest first: a contact of the last tick hands its id on once; a held one takes in every cluster that it is
  /// nearest to.
  void match() noexcept {
    for (;;) {
      std::size_t best = 0, best_old = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < current_.size(); ++i) {
        const track& now = current_[i];
        if (now.id != unknown) continue;
        for (std::size_t k = 0; k < previous_.size(); ++k) {
          const double distance = glm::distance(now.place_w, previous_[k].place_w);
          if (distance >= nearest || !may_be(now, previous_[k])) continue;
          best = i;
          best_old = k;
          nearest = distance;
        }
      }
      if (nearest == std::numeric_limits<double>::infinity()) return;
      if (previous_[best_old].held) {
        current_.erase(current_.begin() + static_cast<std::ptrdiff_t>(best));
        continue;
      }
      current_[best].id = previous_[best_old].id;
      current_[best].u_w = previous_[best_old].u_w;
      previous_.erase(previous_.begin() + static_cast<std::ptrdiff_t>(best_old));
    }
  }

  void report(const side& s, std::uint32_t index, const pose& T_wa, const pose& T_wb, contact_set& out) noexcept {
    for (track& now : current_) {
      contact c;
      c.body = index;
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
      (void)out.add(c, builder_.patch_a(), builder_.patch_b());  // a refusal is counted in out.dropped()
    }
  }

  [[nodiscard]] bool build(const side& s, track& now, const pose& T_wa, const pose& T_wb, contact& c) noexcept {
    if (now.held) {
      now.kept.last_b = inverse(T_wb) * (T_wa * now.kept.p_a);
      return builder_.build(probe(), body(s), T_wa, T_wb, s.settings, now.kept, c);
    }
    const pair_cluster& cluster = clustering_.clusters()[now.cluster];
    if (!builder_.build(probe(), body(s), T_wa, T_wb, s.settings, pairs_, clustering_.members(cluster), cluster, c)) {
      return false;
    }
    now.kept = keep_contact(c, cluster, deepest_pair(cluster), builder_.near(), T_wa, T_wb);
    return true;
  }

  std::vector<collision_body> bodies_;  ///< of every model, the probe's first
  std::vector<side> sides_;
  std::vector<simplex_cache> caches_;  ///< of every model of a fixed body
  // Of the side that is looked at.
  std::vector<close_pair> pairs_;
  pair_clustering clustering_;
  contact_builder builder_;
  std::vector<track> previous_, current_;
  // Of all sides, by side and id.
  std::vector<track> tracks_before_, tracks_;
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
