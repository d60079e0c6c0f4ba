// The one place where tests that draw anew in every run get their seed from: the date, so that all programs of a day
// agree, and each day looks somewhere else. ASPERITY_SEED=N in the environment takes N instead, to repeat a run.
#pragma once

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

namespace asperity::test_support {

/// A seed, and whether ASPERITY_SEED gave it.
struct seed_choice {
  std::uint64_t value = 0;
  bool given = false;
};

/// ASPERITY_SEED, or the date in UTC as yyyymmdd. Ends the program where ASPERITY_SEED is no number: a run that was to
/// be repeated must not silently be another one.
[[nodiscard]] inline seed_choice choose_seed() {
  if (const char* const given = std::getenv("ASPERITY_SEED"); given != nullptr && *given != '\0') {
    char* end = nullptr;
    const std::uint64_t value = std::strtoull(given, &end, 10);
    if (*end == '\0' && std::isdigit(static_cast<unsigned char>(*given)) != 0) return {value, true};
    std::fprintf(stderr, "ASPERITY_SEED is \"%s\"; give a number such as 20261122, or unset it\n", given);
    std::exit(2);
  }
  const std::time_t now = std::time(nullptr);
  std::tm date{};
  gmtime_r(&now, &date);
  return {static_cast<std::uint64_t>((date.tm_year + 1900) * 10000 + (date.tm_mon + 1) * 100 + date.tm_mday), false};
}

/// The seed of one stream of numbers: another one for every name and index, the same in every program of the day.
/// (FNV-1a over the name, splitmix64 over the rest.)
[[nodiscard]] constexpr std::uint64_t seed_of(std::uint64_t seed, std::string_view stream,
                                              std::uint64_t index = 0) noexcept {
  std::uint64_t name = 0xcbf29ce484222325ULL;
  for (const char c : stream) name = (name ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (name ^ (index * 0xd1342543de82ef95ULL + 1));
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

/// Today's seed for a test, printed with what repeats it and with the test's budget.
[[nodiscard]] inline std::uint64_t fresh_seed(std::string_view test, std::string_view budget) {
  const seed_choice seed = choose_seed();
  std::printf("  %.*s: seed %llu (%s; ASPERITY_SEED=%llu repeats it), %.*s\n", static_cast<int>(test.size()),
              test.data(), static_cast<unsigned long long>(seed.value), seed.given ? "given" : "today's date",
              static_cast<unsigned long long>(seed.value), static_cast<int>(budget.size()), budget.data());
  return seed.value;
}

}  // namespace asperity::test_support
