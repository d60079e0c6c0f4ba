// A body's field and samples as bytes: what a textured model's file keeps, so that nobody waits for them at load.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// Which bytes these are. It goes up whenever make_field_body() makes another field of the same model, or the bytes lie
/// in another way: a reader passes over fields of other versions, and they are made at load.
inline constexpr std::uint32_t packed_field_version = 5;

/// The bytes of a field and its samples, little-endian; docs/reference/asset-format.md has their layout. Bounds that
/// follow from them are left out. Allocates.
[[nodiscard]] ASPERITY_API std::vector<std::byte> pack_field(const field_body& body);

/// The field and the samples that bytes hold, the same to the bit as those that were packed. The bytes may come from
/// anybody: whatever they are, reading the result touches nothing outside of it.
/// @param threads that work out its bounds; 0: as many as the machine has
/// @return bad_format, with what is wrong; limit_exceeded where it is larger than a field can be
[[nodiscard]] ASPERITY_API result<field_body> unpack_field(std::span<const std::byte> bytes, unsigned threads = 0);

/// Whether a field was made of a model as it is now, with these settings. Reads the whole mesh and texture: a few
/// milliseconds.
[[nodiscard]] ASPERITY_API bool is_made_of(const field_body& body, const textured_model& model,
                                           const field_body_settings& settings = {});

}  // namespace asperity
