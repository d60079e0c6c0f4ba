// Options that choose and tune the three policies; the same for query, run and bench.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "asperity/asperity.hpp"
#include "cli.hpp"

namespace asperity::command {

struct render_options {
  std::string contacts = "shared";
  std::string backend = "cpu";
  std::optional<std::string> gradient;  ///< of the paper's contacts only
  std::optional<std::uint32_t> grid;    ///< of the paper's contacts only
  bool allow_scale_mismatch = false;
};

/// --contacts, --backend, --gradient, --grid and --allow-scale-mismatch.
void add_render_options(CLI::App& sub, render_options& options);

/// What the options come to, for documents and captions.
[[nodiscard]] std::string gradient_name(const render_options& options);
[[nodiscard]] json grid_json(const render_options& options);

/// A renderer of either formulation, chosen at run time.
class chosen_renderer {
 public:
  explicit chosen_renderer(renderer r) : either_(std::move(r)) {}
  explicit chosen_renderer(paper_renderer r) : either_(std::move(r)) {}

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    if (auto* const shared = std::get_if<renderer>(&either_)) return shared->step(at, out);
    return std::get_if<paper_renderer>(&either_)->step(at, out);
  }
  [[nodiscard]] const asperity::scene& scene() const noexcept {
    if (const auto* const shared = std::get_if<renderer>(&either_)) return shared->scene();
    return std::get_if<paper_renderer>(&either_)->scene();
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    if (const auto* const shared = std::get_if<renderer>(&either_)) return shared->memory_bytes();
    return std::get_if<paper_renderer>(&either_)->memory_bytes();
  }

 private:
  std::variant<renderer, paper_renderer> either_;
};

/// Says what does not go together; asked before models are loaded, which takes longer.
/// @return unsupported (a backend that is not part of this build) | invalid_argument
[[nodiscard]] result<void> check(const render_options& options);

/// The renderer that the options ask for.
/// @return what check() says, or make_renderer()
[[nodiscard]] result<chosen_renderer> make_chosen_renderer(scene bodies, const render_options& options);

}  // namespace asperity::command
