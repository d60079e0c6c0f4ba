// The bodies of a scene as a search for ways out needs them: fields with bounds, samples in branches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/field/sample_tree.hpp"
#include "field/threads.hpp"
#include "least_motion/field_bounds.hpp"
#include "least_motion/kept_relief.hpp"
#include "least_motion/make_moving_shape.hpp"
#include "least_motion/mark_tree.hpp"
#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// The samples of a body and those in the middle of its plain faces, in one tree; empty where it has no plain ones.
[[nodiscard]] inline sample_tree all_samples(const field_body& body, unsigned threads) {
  const std::span<const field_sample> told = body.samples.samples(), plain = body.plain.samples();
  if (plain.empty()) return {};
  std::vector<field_sample> all(told.begin(), told.end());
  all.insert(all.end(), plain.begin(), plain.end());
  return sample_tree(std::move(all), threads);
}

/// One body. Immutable once made.
struct exit_body {
  field_body_ptr body;
  sample_tree with_plain;  ///< all of its samples; empty where the body's own tree has all
  kept_relief relief;
  moving_shape shape;
  field_bounds bounds;
  mark_tree marks;

  /// @param threads that work at once; what is made does not depend on them
  /// @pre made
  exit_body(field_body_ptr made, unsigned threads)
      : body(std::move(made)),
        with_plain(all_samples(*body, threads)),
        relief(usual_relief(body->field, samples().samples())),
        shape(make_moving_shape(body->field, relief, threads)),
        bounds(shape, threads),
        marks(samples()) {}
  exit_body(const exit_body&) = delete;  // marks look at its samples
  exit_body& operator=(const exit_body&) = delete;
  exit_body(exit_body&&) = delete;
  exit_body& operator=(exit_body&&) = delete;
  ~exit_body() = default;

  [[nodiscard]] const sample_tree& samples() const noexcept {
    return body->plain.samples().empty() ? body->samples : with_plain;
  }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(with_plain, shape, bounds, marks);
  }
};

using exit_body_ptr = std::shared_ptr<const exit_body>;

/// One per body, in the order of the scene; a body that appears several times is made once. Immutable once made.
struct exit_scene {
  exit_body_ptr probe;
  std::vector<exit_body_ptr> fixed;

  /// Allocates; for a tenth of a second a body and more for long notches, not for a tick. Starts threads, which have
  /// ended when it returns.   @pre all bodies of made are there
  explicit exit_scene(const field_scene& made) {
    std::vector<field_body_ptr> bodies{made.probe};
    for (const field_body_ptr& b : made.fixed) {
      if (std::find(bodies.begin(), bodies.end(), b) == bodies.end()) bodies.push_back(b);
    }
    std::vector<exit_body_ptr> ready(bodies.size());
    // Each has all threads, because one that is done leaves the machine to the others.
    const unsigned threads = detail::resolve_threads(0);
    detail::for_each_task(bodies.size(), threads,
                          [&](std::size_t i) { ready[i] = std::make_shared<const exit_body>(bodies[i], threads); });
    probe = ready[0];
    for (const field_body_ptr& b : made.fixed) {
      fixed.push_back(ready[static_cast<std::size_t>(std::find(bodies.begin(), bodies.end(), b) - bodies.begin())]);
    }
  }

  /// Whether it was made of these bodies, in this order.
  [[nodiscard]] bool is_of(const field_scene& made) const noexcept {
    return probe->body == made.probe &&
           std::equal(fixed.begin(), fixed.end(), made.fixed.begin(), made.fixed.end(),
                      [](const exit_body_ptr& own, const field_body_ptr& b) { return own->body == b; });
  }

  /// Without the fields and samples, which belong to the field_scene.
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(fixed) + sizeof(exit_body) + probe->heap_bytes();
    for (auto b = fixed.begin(); b != fixed.end(); ++b) {
      const bool counted = *b == probe || std::find(fixed.begin(), b, *b) != b;
      if (!counted) bytes += sizeof(exit_body) + (*b)->heap_bytes();
    }
    return bytes;
  }
};

}  // namespace asperity::exits
