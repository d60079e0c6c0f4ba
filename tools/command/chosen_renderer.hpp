// A renderer of either formulation, chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "asperity/render/renderer.hpp"

namespace asperity::command {

/// What the options of the command line choose; see render_options.hpp.
struct render_options {
  std::string contacts = "shared";
  std::string backend = "cpu";
  std::optional<std::string> gradient;  ///< of the paper's contacts only
  std::optional<std::uint32_t> grid;    ///< of the paper's contacts only
  bool allow_scale_mismatch = false;
};

/// Both formulations behind one door, compiled once: each takes the compiler longer than the rest of a subcommand.
class chosen_renderer {
 public:
  struct either;  ///< holds the one that was chosen

  explicit chosen_renderer(std::unique_ptr<either> chosen) noexcept;
  chosen_renderer(chosen_renderer&&) noexcept;
  chosen_renderer& operator=(chosen_renderer&&) noexcept;
  ~chosen_renderer();

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept;
  [[nodiscard]] const asperity::scene& scene() const noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  std::unique_ptr<either> either_;
};

/// Says what does not go together; asked before models are loaded, which takes longer.
/// @return unsupported (a backend that is not part of this build) | invalid_argument
[[nodiscard]] result<void> check(const render_options& options);

/// The renderer that the options ask for.
/// @return what check() says, or make_renderer()
[[nodiscard]] result<chosen_renderer> make_chosen_renderer(scene bodies, const render_options& options);

}  // namespace asperity::command
