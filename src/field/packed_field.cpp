#include "asperity/field/packed_field.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "field/field_bytes.hpp"
#include "field/model_digest.hpp"
#include "field/threads.hpp"

namespace asperity {
namespace detail {

/// Reads and writes what no user of a field sees: the boxes of its slopes and the balls of its samples.
class field_parts {
 public:
  static void write(const slope_boxes& boxes, field_writer& to) {
    to.sparse(std::span<const slope_boxes::box>(boxes.blocks_), slope_boxes::box{});
  }
  static slope_boxes read_slopes(const coarse_grid& of, field_reader& from) {
    slope_boxes out(of);
    from.sparse(std::span(out.blocks_), "slopes");
    for (const slope_boxes::box& s : out.blocks_) {
      const bool is_empty = !(s.low.x <= s.high.x);
      const bool is_finite = all_finite({&s.low.x, 3}) && all_finite({&s.high.x, 3});
      if (!is_finite && !(is_empty && std::memcmp(&s, &no_slopes, sizeof s) == 0)) {
        from.reject("a box of slopes is not finite");
        break;
      }
    }
    return out;
  }

  static void write(const sample_tree& tree, field_writer& to) {
    to.number(std::uint64_t{tree.samples_.size()});
    if (tree.samples_.empty()) return;
    to.array(std::span<const field_sample>(tree.samples_));
    to.number(std::uint64_t{tree.places_});
    for (const sample_tree::ball& b : tree.balls_) {
      if (b.right == 0) to.number(static_cast<std::uint8_t>(b.count));
    }
    for (const sample_tree::ball& b : tree.balls_) to.array(std::span<const float>(numbers_of(b)));
  }
  static sample_tree read_tree(field_reader& from, bool may_be_empty) {
    sample_tree out;
    const auto count = from.number<std::uint64_t>("the number of samples");
    out.samples_ = from.array<field_sample>(static_cast<std::size_t>(count), "samples");
    if (out.samples_.empty()) {
      if (!may_be_empty) from.reject("it has no samples");
      return out;
    }
    static_assert(sizeof(field_sample) == 7 * sizeof(float), "all of its bytes are numbers");
    const std::span<const float> numbers(reinterpret_cast<const float*>(out.samples_.data()), out.samples_.size() * 7);
    if (!all_finite(numbers)) from.reject("a sample is not finite");
    const auto places = from.number<std::uint64_t>("the number of places");
    if (places < 1 || places > count) {
      from.reject("it has " + std::to_string(places) + " places of " + std::to_string(count) + " samples");
      return out;
    }
    out.places_ = static_cast<std::size_t>(places);
    // A tree of halves has one leaf more than other balls.
    const std::size_t all_balls = sample_tree::balls_of(out.places_);
    const auto in_leaf = from.array<std::uint8_t>((all_balls + 1) / 2, "the numbers of samples in leaves");
    const auto balls = from.array<std::array<float, ball_numbers>>(all_balls, "balls of samples");
    out.balls_.resize(balls.size());
    for (std::size_t i = 0; i < balls.size(); ++i) {
      if (!all_finite(balls[i])) {
        from.reject("a ball of samples is not finite");
        return out;
      }
      from_numbers(balls[i], out.balls_[i]);
    }
    if (out.balls_.empty() || in_leaf.empty()) return out;
    const auto [least, most] = std::minmax_element(in_leaf.begin(), in_leaf.end());
    if (*least < 1 || *most > sample_tree::leaf_samples) from.reject("a leaf has no sample, or too many");
    std::span<const std::uint8_t> leaves = in_leaf;
    if (lay_out(out.balls_, {0, out.places_, 0}, leaves) != out.samples_.size()) {
      from.reject("its leaves do not hold all of its samples, or more");
    }
    return out;
  }

 private:
  static constexpr std::size_t ball_numbers = 8;
  static constexpr slope_boxes::box no_slopes{};

  static std::array<float, ball_numbers> numbers_of(const sample_tree::ball& b) noexcept {
    return {b.centre_b.x, b.centre_b.y, b.centre_b.z, b.axis_b.x, b.axis_b.y, b.axis_b.z, b.radius_m, b.half_m};
  }
  static void from_numbers(const std::array<float, ball_numbers>& n, sample_tree::ball& b) noexcept {
    b.centre_b = {n[0], n[1], n[2]};
    b.axis_b = {n[3], n[4], n[5]};
    b.radius_m = n[6];
    b.half_m = n[7];
  }

  /// Which samples a ball holds, and where its halves are, follow from the number of places and the samples in leaves.
  struct part {
    std::size_t first, places, self;
  };
  /// @param leaves from the first one of this part on; what is left are those behind it   @return its samples
  static std::size_t lay_out(std::vector<sample_tree::ball>& balls, const part& of,
                             std::span<const std::uint8_t>& leaves) noexcept {
    sample_tree::ball& b = balls[of.self];
    b.first = static_cast<std::uint32_t>(of.first);
    if (of.places <= sample_tree::leaf_places) {
      b.count = leaves.front();
      leaves = leaves.subspan(1);
      return b.count;
    }
    const std::size_t half = of.places / 2, right = of.self + 1 + sample_tree::balls_of(half);
    b.right = static_cast<std::uint32_t>(right);
    const std::size_t left = lay_out(balls, {of.first, half, of.self + 1}, leaves);
    const std::size_t all = left + lay_out(balls, {of.first + left, of.places - half, right}, leaves);
    b.count = static_cast<std::uint32_t>(all);
    return all;
  }
};

}  // namespace detail

namespace {

using namespace detail;  // what a field is made of

// A field of any model is smaller than these, and a file of a few bytes cannot ask for more memory than they take.
constexpr std::uint64_t most_nodes = 64'000'000, most_places = 16'000'000, most_bricks = 1'000'000;
constexpr double largest_m = 1e4, smallest_pitch_m = 1e-9;

void write(const field_body_settings& settings, field_writer& to) {
  const field_settings& f = settings.field;
  for (const double x : {f.pitch_m, f.relief_pitch_m, f.margin_m, settings.sample_pitch_m}) to.number(x);
  to.number(std::uint64_t{f.most_nodes});
  to.number(std::uint64_t{f.relief_bytes});
}

field_body_settings read_settings(field_reader& from) {
  field_body_settings out;
  for (double* x : {&out.field.pitch_m, &out.field.relief_pitch_m, &out.field.margin_m, &out.sample_pitch_m}) {
    *x = from.number_between(0.0, largest_m, "a setting");
  }
  out.field.most_nodes = static_cast<std::size_t>(from.number<std::uint64_t>("a setting"));
  out.field.relief_bytes = static_cast<std::size_t>(from.number<std::uint64_t>("a setting"));
  return out;
}

void write(const std::array<std::size_t, 3>& along, field_writer& to) {
  for (const std::size_t n : along) to.number(static_cast<std::uint32_t>(n));
}

/// Three counts, and their product. Rejects where one is below `least` or the product above `most`.
std::size_t read_counts(std::array<std::size_t, 3>& along, std::uint64_t least, std::uint64_t most, const char* name,
                        field_reader& from) {
  std::uint64_t product = 1;
  for (std::size_t& n : along) {
    n = from.number<std::uint32_t>(name);
    if (n < least || n > most || product > most / n) {
      from.reject(std::string(name) + " are too few or too many");
      return 0;
    }
    product *= n;
  }
  return static_cast<std::size_t>(product);
}

void write(const coarse_grid& grid, field_writer& to) {
  to.vector(grid.low);
  to.number(grid.pitch_m);
  write(grid.nodes, to);
  to.array(std::span<const float>(grid.value));
}

coarse_grid read_grid(field_reader& from) {
  coarse_grid out;
  out.low = from.vector(largest_m, "the corner of its grid");
  out.pitch_m = from.number_between(smallest_pitch_m, largest_m, "the pitch of its grid");
  const std::size_t nodes = read_counts(out.nodes, 4, most_nodes, "the nodes of its grid", from);
  out.value = from.array<float>(nodes, "its grid");
  if (!all_finite(out.value)) from.reject("a node of its grid is not finite");
  return out;
}

void write(const relief_bricks& fine, field_writer& to) {
  to.vector(fine.low);
  to.number(fine.pitch_m);
  write(fine.bricks_along, to);
  to.sparse(std::span<const std::uint32_t>(fine.index), 0U);
  to.number(std::uint64_t{fine.bricks.size()});
  to.sparse(std::span<const float>(fine.bricks[0].data(), fine.bricks.size() * relief_bricks::nodes_per_brick), 0.0F);
}

relief_bricks read_bricks(field_reader& from) {
  relief_bricks out;
  out.low = from.vector(largest_m, "the corner of its relief");
  out.pitch_m = from.number_between(smallest_pitch_m, largest_m, "the pitch of its relief");
  const std::size_t places = read_counts(out.bricks_along, 1, most_places, "the bricks of its relief", from);
  if (!from.may_hold_sparse(places, "the places of its relief")) return out;
  out.index.assign(places, 0U);
  from.sparse(std::span(out.index), "the places of its relief");
  const auto bricks = from.number<std::uint64_t>("the number of bricks");
  if (bricks < 1 || bricks > most_bricks) {
    from.reject("it has " + std::to_string(bricks) + " bricks, not 1 to " + std::to_string(most_bricks));
    return out;
  }
  if (std::any_of(out.index.begin(), out.index.end(), [&](std::uint32_t i) { return i >= bricks; })) {
    from.reject("a place of its relief names a brick that there is not");
    return out;
  }
  const std::size_t count = static_cast<std::size_t>(bricks) * relief_bricks::nodes_per_brick;
  if (!from.may_hold_sparse(count, "its relief")) return out;
  out.bricks.assign(static_cast<std::size_t>(bricks), relief_bricks::brick{});
  const std::span<float> nodes(out.bricks[0].data(), count);
  from.sparse(nodes, "its relief");
  if (!all_finite(nodes)) from.reject("a node of its relief is not finite");
  return out;
}

}  // namespace

std::vector<std::byte> pack_field(const field_body& body) {
  const body_field& f = body.field;
  field_writer to;
  to.number(packed_field_version);
  to.number(std::uint32_t{0});
  to.number(body.of_model);
  write(body.made_with, to);
  for (const double x : {f.lowest_relief_m, f.highest_relief_m, f.thickness_m, f.thinnest_resolved_m}) to.number(x);
  write(f.smooth, to);
  write(f.fine, to);
  field_parts::write(f.slopes, to);
  field_parts::write(body.samples, to);
  field_parts::write(body.plain, to);
  return to.take();
}

result<field_body> unpack_field(std::span<const std::byte> bytes, unsigned threads) {
  field_reader from(bytes);
  field_body out;
  body_field& f = out.field;
  const auto version = from.number<std::uint32_t>("its version");
  if (from.wrong().empty() && version != packed_field_version) {
    return error{error_code::unsupported, "the field is of version " + std::to_string(version) +
                                              ", and this build reads version " + std::to_string(packed_field_version)};
  }
  static_cast<void>(from.number<std::uint32_t>("its head"));
  out.of_model = from.number<std::uint64_t>("its digest");
  out.made_with = read_settings(from);
  f.lowest_relief_m = from.number_between(-largest_m, 0.0, "its lowest relief");
  f.highest_relief_m = from.number_between(0.0, largest_m, "its highest relief");
  f.thickness_m = from.number_between(0.0, largest_m, "its thickness");
  f.thinnest_resolved_m = from.number_between(0.0, largest_m, "its thinnest part");
  f.smooth = read_grid(from);
  f.fine = read_bricks(from);
  if (from.wrong().empty()) f.slopes = field_parts::read_slopes(f.smooth, from);
  out.samples = field_parts::read_tree(from, false);
  out.plain = field_parts::read_tree(from, true);
  if (from.wrong().empty() && from.left() != 0) from.reject("bytes follow after its end");
  if (!from.wrong().empty()) return error{error_code::bad_format, "the field is damaged: " + from.wrong()};
  for_each_task(2, resolve_threads(threads), [&](std::size_t task) {
    if (task == 0) {
      f.most_third = third_bounds(f.smooth);
    } else {
      f.most_relief = relief_bounds(f.fine);
    }
  });
  return out;
}

bool is_made_of(const field_body& body, const textured_model& model, const field_body_settings& settings) {
  // Without a map plain samples are left out, and with one each tells of what it is.
  const bool tells_materials = model.surface_map.empty() || body.plain.samples().empty();
  return tells_materials && body.made_with == without_threads(settings) && body.of_model == model_digest(model);
}

}  // namespace asperity
