#include "field_upload.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <span>

#include "asperity/field/field_body.hpp"
#include "plane_layout.hpp"

namespace asperity::gl {
namespace {

// Where the parts of a body begin.
struct body_place {
  std::size_t numbers = 0, integers = 0, leaves = 0, balls = 0, samples = 0, leaf_count = 0;
};

class packer {
 public:
  explicit packer(packed_fields& out) : out_(&out) {}

  const body_place& place_of(const field_body& body) {
    const auto there = places_.find(&body);
    return there != places_.end() ? there->second : places_.emplace(&body, add(body)).first->second;
  }

 private:
  void number(double x) { out_->bodies.push_back(x); }
  void numbers(const vec3& v) {
    for (int k = 0; k < 3; ++k) number(v[k]);
  }
  void integer(std::size_t i) { out_->table.push_back(static_cast<std::int32_t>(i)); }
  void node(double x) { out_->nodes.push_back(static_cast<float>(x)); }

  body_place add(const field_body& body) {
    const body_field& f = body.field;
    body_place at;
    at.numbers = out_->bodies.size();
    numbers(f.smooth.low);
    number(f.smooth.pitch_m);
    numbers(f.fine.low);
    number(f.fine.pitch_m);
    number(f.highest_relief_m);

    const std::size_t first_node = out_->nodes.size();
    out_->nodes.insert(out_->nodes.end(), f.smooth.value.begin(), f.smooth.value.end());
    const std::size_t first_brick = out_->nodes.size();
    for (const auto& brick : f.fine.bricks) out_->nodes.insert(out_->nodes.end(), brick.begin(), brick.end());
    const std::size_t first_index = out_->table.size();
    for (const std::uint32_t i : f.fine.index) integer(i);

    at.integers = out_->table.size();
    for (const std::size_t n : f.smooth.nodes) integer(n);
    integer(first_node);
    for (const std::size_t n : f.fine.bricks_along) integer(n);
    integer(first_index);
    integer(first_brick);

    at.samples = out_->nodes.size();
    for (const field_sample& s : body.samples.samples()) {
      const auto [full, none] = facing::cosines_of(static_cast<double>(s.cone_rad));
      for (int k = 0; k < 3; ++k) out_->nodes.push_back(s.position_b[k]);
      for (int k = 0; k < 3; ++k) out_->nodes.push_back(s.axis_b[k]);
      node(full);
      node(none);
    }
    at.balls = out_->nodes.size();
    at.leaves = out_->table.size();
    const field_sample* const first = body.samples.samples().data();
    body.samples.query([](const sample_ball&, bool) noexcept { return sample_tree::branch_answer::taken; },
                       [&](const sample_ball& ball, std::span<const field_sample> samples) noexcept {
                         for (int k = 0; k < 3; ++k) node(ball.centre_b[k]);
                         node(ball.radius_m);
                         integer(static_cast<std::size_t>(samples.data() - first));
                         integer(samples.size());
                         ++at.leaf_count;
                       });
    return at;
  }

  packed_fields* out_;
  std::map<const field_body*, body_place> places_;
};

}  // namespace

result<packed_fields> pack_fields(const field_scene& made) {
  packed_fields out;
  out.bodies.resize(planes::scene_numbers);  // which plane_batch fills in
  const std::size_t meetings = 2 * made.fixed.size();
  out.table.resize(meetings * planes::meeting_integers);
  packer pack(out);
  for (std::size_t m = 0; m < meetings; ++m) {
    const field_body &A = *made.probe, &B = *made.fixed[m / 2];
    const body_place x = pack.place_of(m % 2 == 0 ? A : B), y = pack.place_of(m % 2 == 0 ? B : A);
    std::int32_t* const to = out.table.data() + m * planes::meeting_integers;
    to[planes::leaves] = static_cast<std::int32_t>(x.leaf_count);
    to[planes::first_leaf] = static_cast<std::int32_t>(x.leaves);
    to[planes::first_ball] = static_cast<std::int32_t>(x.balls);
    to[planes::first_sample] = static_cast<std::int32_t>(x.samples);
    to[planes::field_numbers] = static_cast<std::int32_t>(y.numbers);
    to[planes::field_integers] = static_cast<std::int32_t>(y.integers);
    out.most_leaves = std::max(out.most_leaves, x.leaf_count);
  }
  constexpr auto largest = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (out.nodes.size() > largest || out.table.size() > largest) {
    return error{error_code::limit_exceeded,
                 "plane batch: the fields of these bodies have more than 2^31 numbers; make them coarser"};
  }
  return out;
}

}  // namespace asperity::gl
