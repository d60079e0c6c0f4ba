// Encoders over every float there is, as fast as the machine can: for the tests that leave none out.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <type_traits>
#include <vector>

#include "support/extent.hpp"

namespace asperity::test_support {

inline constexpr std::uint64_t all_floats = std::uint64_t{1} << 32U;
inline constexpr std::uint64_t float_sign = std::uint64_t{1} << 31U;

[[nodiscard]] constexpr double float_of(std::uint64_t bits) noexcept {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
}

/// How many patterns are encoded at a time.
inline constexpr std::uint32_t floats_at_once = 512;

template <class Encode>
using encoded_floats = std::array<std::invoke_result_t<const Encode&, double>, floats_at_once>;

namespace detail {

// Where an encoder comes to no branch, this is several floats per instruction.
template <class Encode>
[[gnu::always_inline]] inline void encode_each(const Encode& encode, std::uint32_t first, encoded_floats<Encode>& out) {
  const Encode here = encode;  // what lies elsewhere would be read again for every float
  for (std::uint32_t i = 0; i < floats_at_once; ++i) {
    out[i] = here(static_cast<double>(std::bit_cast<float>(first + i)));
  }
}

template <class Encode>
[[gnu::flatten]] void encode_anywhere(const Encode& encode, std::uint32_t first, encoded_floats<Encode>& out) {
  encode_each(encode, first, out);
}

// The same arithmetic in wider registers: AVX2 brings no fused multiply-add, so that the results are the same.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
template <class Encode>
[[gnu::flatten, gnu::target("avx2")]] void encode_wide(const Encode& encode, std::uint32_t first,
                                                       encoded_floats<Encode>& out) {
  encode_each(encode, first, out);
}
[[nodiscard]] inline bool is_wide() noexcept { return __builtin_cpu_supports("avx2") != 0; }
#else
template <class Encode>
void encode_wide(const Encode& encode, std::uint32_t first, encoded_floats<Encode>& out) {
  encode_each(encode, first, out);
}
[[nodiscard]] inline bool is_wide() noexcept { return false; }
#endif

}  // namespace detail

/// Encodes `floats_at_once` patterns from `first` on.
template <class Encode>
void encode_floats(const Encode& encode, std::uint32_t first, encoded_floats<Encode>& out) {
  static const bool wide = detail::is_wide();
  wide ? detail::encode_wide(encode, first, out) : detail::encode_anywhere(encode, first, out);
}

/// Of the stretches of `floats_at_once` patterns that follow each other, an ordinary run takes one in so many: 268 of
/// each exponent's 16384. A run at length takes all.
inline constexpr std::uint64_t one_stretch_in = 61;

/// Hands out the patterns in [from, to) in blocks, on all cores. No block has both signs, or numbers and NaN; the only
/// infinity of a block is its first pattern.
/// @param count  count(begin, end): how many of a block were refused
/// @return how many were refused in all
template <class Count>
[[nodiscard]] std::uint64_t in_blocks(std::uint64_t from, std::uint64_t to, const Count& count) {
  constexpr std::uint64_t block = std::uint64_t{1} << 22U;
  std::atomic<std::uint64_t> next{from / block};
  std::atomic<std::uint64_t> bad{0};
  const bool all = at_length();
  const auto count_block = [&](std::uint64_t begin, std::uint64_t end) {
    if (all) return count(begin, end);
    std::uint64_t refused_here = count(begin, begin + 1) + count(end - 1, end);
    for (std::uint64_t at = begin; at < end; at += one_stretch_in * floats_at_once) {
      refused_here += count(at, std::min<std::uint64_t>(at + floats_at_once, end));
    }
    return refused_here;
  };
  std::vector<std::thread> workers;
  for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t) {
    workers.emplace_back([&] {
      for (std::uint64_t at = next++ * block; at < to; at = next++ * block) {
        bad += count_block(std::max(at, from), std::min(at + block, to));
      }
    });
  }
  for (std::thread& w : workers) w.join();
  return bad;
}

/// Encodes every pattern in [from, to). Within a run of patterns with the same result the size of what was asked for
/// only grows, so `fair` is asked about the first and the last of each run, and with them about all.
/// @param encode  encode(double): what goes onto the wire; everything that it needs it holds by value
/// @param fair    fair(asked, sent): whether that may be sent
/// @return how many were refused
template <class Encode, class Fair>
[[nodiscard]] std::uint64_t refused(std::uint64_t from, std::uint64_t to, const Encode& encode, const Fair& fair) {
  return in_blocks(from, to, [&](std::uint64_t begin, std::uint64_t end) {
    std::uint64_t bad = 0;
    const auto look = [&](std::uint64_t bits, auto sent) { bad += fair(float_of(bits), sent) ? 0U : 1U; };
    auto run = encode(float_of(begin));
    look(begin, run);
    encoded_floats<Encode> sent;
    for (std::uint64_t at = begin; at < end; at += floats_at_once) {
      // A block that is cut short is encoded beyond its end; what lies there is nobody's here.
      encode_floats(encode, static_cast<std::uint32_t>(at), sent);
      const auto here = static_cast<std::size_t>(std::min<std::uint64_t>(floats_at_once, end - at));
      std::uint32_t others = 0;
      for (std::uint32_t i = 0; i < floats_at_once; ++i) others += sent[i] == run ? 0U : 1U;
      if (others == 0) continue;
      for (std::size_t i = 0; i < here; ++i) {
        if (sent[i] == run) continue;
        if (at + i > begin) look(at + i - 1, run);
        look(at + i, sent[i]);
        run = sent[i];
      }
    }
    look(end - 1, run);
    return bad;
  });
}

}  // namespace asperity::test_support
