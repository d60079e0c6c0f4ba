// What has to be true of a reader's answer, whatever the bytes were.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "support/sanitizers.hpp"

namespace asperity::hostile {

/// One in so many of the usual runs, where the build is slow.
#if ASPERITY_ADDRESS_SANITIZER || !defined(NDEBUG)
inline constexpr std::size_t share = 8;
#else
inline constexpr std::size_t share = 1;
#endif

/// Says what is wrong with an answer; nothing where all is well:
/// - an error has one printable line of sensible length with a mend in it;
/// - an image has a size within the reader's limits, a sample for each pixel and channel, all finite;
/// - a mesh has finite positions and indices in range;
/// - a model is valid, a renderer can be made for it, and a tick of it against itself gives finite numbers.
[[nodiscard]] std::optional<std::string> complaint(const result<map_image>& image);
[[nodiscard]] std::optional<std::string> complaint(const result<triangle_mesh>& mesh);
[[nodiscard]] std::optional<std::string> complaint(const result<textured_model>& model);

/// The message with numbers and quoted words left out: what kind of refusal it is.
[[nodiscard]] std::string kind_of(std::string_view message);

}  // namespace asperity::hostile
