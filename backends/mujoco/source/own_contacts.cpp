// Whether MuJoCo makes contacts between two objects itself, and how it is kept from it.
#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "asperity/mujoco/textured_contacts.hpp"
#include "find_objects.hpp"

namespace asperity::mujoco {
namespace {

// contype and conaffinity of every geom.
struct masks {
  std::vector<int> type, affinity;

  explicit masks(const mjModel& m)
      : type(m.geom_contype, m.geom_contype + m.ngeom), affinity(m.geom_conaffinity, m.geom_conaffinity + m.ngeom) {}
  [[nodiscard]] bool collide(int a, int b) const noexcept {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    return (type[i] & affinity[j]) != 0 || (type[j] & affinity[i]) != 0;
  }
  /// A bit that no geom uses; 0 where there is none.
  [[nodiscard]] int free_bit() const noexcept {
    unsigned used = 0;
    for (const int t : type) used |= static_cast<unsigned>(t);
    for (const int a : affinity) used |= static_cast<unsigned>(a);
    for (unsigned bit = 0; bit < 31; ++bit) {
      if ((used & (1U << bit)) == 0) return static_cast<int>(1U << bit);
    }
    return 0;
  }
};

bool has_pair_element(const mjModel& m, int a, int b) {
  if (m.opt.collision == mjCOL_DYNAMIC) return false;
  for (int i = 0; i < m.npair; ++i) {
    const int g1 = m.pair_geom1[i], g2 = m.pair_geom2[i];
    if ((g1 == a && g2 == b) || (g1 == b && g2 == a)) return true;
  }
  return false;
}

// What MuJoCo asks of two bodies before it looks at their geoms.
bool bodies_are_filtered(const mjModel& m, int a, int b) {
  if (m.opt.collision == mjCOL_PAIR) return true;
  const int wa = m.body_weldid[a], wb = m.body_weldid[b];
  if (wa == wb) return true;
  const bool with_parents = (m.opt.disableflags & mjDSBL_FILTERPARENT) == 0;
  const auto weld_parent = [&m](int w) { return m.body_weldid[m.body_parentid[w]]; };
  if (with_parents && wa != 0 && wb != 0 && (wa == weld_parent(wb) || wb == weld_parent(wa))) return true;
  const int low = std::min(a, b), high = std::max(a, b);
  const int signature = ((low + 1) << 16) + high + 1;
  return std::find(m.exclude_signature, m.exclude_signature + m.nexclude, signature) !=
         m.exclude_signature + m.nexclude;
}

colliding_geoms find_colliding(const mjModel& m, const masks& of, const found_object& probe,
                               const found_object& fixed) {
  if ((m.opt.disableflags & (mjDSBL_CONSTRAINT | mjDSBL_CONTACT)) != 0) return {};
  const bool filtered = bodies_are_filtered(m, probe.body, fixed.body);
  for (const int a : geoms_of(m, probe)) {
    for (const int b : geoms_of(m, fixed)) {
      if (has_pair_element(m, a, b)) return {a, b, true};
      if (!filtered && of.collide(a, b)) return {a, b, false};
    }
  }
  return {};
}

}  // namespace

colliding_geoms find_own_contacts(const mjModel& m, const found_object& probe, const found_object& fixed) {
  return find_colliding(m, masks(m), probe, fixed);
}

result<void> switch_off_own_contacts(mjModel_& m, std::span<const textured_pair> pairs) {
  masks of(m);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string where = "MuJoCo pair " + std::to_string(i);
    const result<found_object> probe = find_object(m, pairs[i].probe, where + ", probe");
    if (!probe) return probe.error();
    const result<found_object> fixed = find_object(m, pairs[i].fixed, where + ", fixed");
    if (!fixed) return fixed.error();
    const std::vector<int> others = geoms_of(m, *fixed);
    const std::set<int> avoided(others.begin(), others.end());
    // A geom of the probe that would collide is seen from now on by those that it collides with, and not by `avoided`.
    for (colliding_geoms hit = find_colliding(m, of, *probe, *fixed); hit.of_probe >= 0;
         hit = find_colliding(m, of, *probe, *fixed)) {
      if (hit.by_pair_element) {
        return error{error_code::unsupported, where + ": " + name_of(m, mjOBJ_GEOM, hit.of_probe) + " and " +
                                                  name_of(m, mjOBJ_GEOM, hit.of_fixed) +
                                                  " are in a <pair> element of the MJCF, which contype and conaffinity "
                                                  "do not rule: take the element out"};
      }
      const int bit = of.free_bit();
      if (bit == 0) {
        return error{error_code::limit_exceeded,
                     where +
                         ": the model's geoms use all 31 bits of contype and conaffinity: give the two bodies an "
                         "<exclude> element in the MJCF instead"};
      }
      for (int other = 0; other < m.ngeom; ++other) {
        if (other != hit.of_probe && !avoided.contains(other) && of.collide(hit.of_probe, other)) {
          of.affinity[static_cast<std::size_t>(other)] |= bit;
        }
      }
      of.type[static_cast<std::size_t>(hit.of_probe)] = bit;
      of.affinity[static_cast<std::size_t>(hit.of_probe)] = 0;
    }
  }
  std::copy(of.type.begin(), of.type.end(), m.geom_contype);
  std::copy(of.affinity.begin(), of.affinity.end(), m.geom_conaffinity);
  return {};
}

}  // namespace asperity::mujoco
