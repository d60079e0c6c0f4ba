// Changes image files at random and keeps their structure, so that mutations reach what lies behind the first checks.
#pragma once

#include <string>

#include "random_source.hpp"

namespace asperity::hostile {

/// Any file: bits, bytes, words and runs changed, pieces dropped and doubled, the end cut off.
[[nodiscard]] std::string mutated_bytes(const std::string& bytes, random_source& random);

// One to three changes that know the format. Where an earlier change left nothing that they can read, bytes change.

/// Fields of the header, content, order, names and lengths of chunks; checksums are right afterwards, mostly.
[[nodiscard]] std::string mutated_png(const std::string& png, random_source& random);
/// Sizes, components, tables, segments dropped, doubled and swapped, lengths, bytes of the scan.
[[nodiscard]] std::string mutated_jpeg(const std::string& jpeg, random_source& random);
/// Tags, types, counts, values and offsets of the directory, entries dropped and doubled, bytes of the pixels.
[[nodiscard]] std::string mutated_tiff(const std::string& tiff, random_source& random);
/// Attributes of the header (windows, channels, compression, their sizes and names), version flags, offsets, bytes of
/// the pixels. Offsets follow where the header changes its length.
[[nodiscard]] std::string mutated_exr(const std::string& exr, random_source& random);

/// A number that stands in a file, or one near it, or one that hurts.
[[nodiscard]] std::uint32_t changed_number(std::uint32_t value, random_source& random);

}  // namespace asperity::hostile
