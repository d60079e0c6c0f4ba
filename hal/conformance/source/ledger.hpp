// What the kit has found, check by check.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace asperity::conformance {

enum class outcome : std::uint8_t { passed, failed, not_applicable };

[[nodiscard]] constexpr const char* to_string(outcome o) noexcept {
  switch (o) {
    case outcome::passed:
      return "pass";
    case outcome::failed:
      return "FAIL";
    case outcome::not_applicable:
      return "not applicable";
  }
  return "unknown";
}

struct check_result {
  std::string name;
  std::string asks;  ///< what the check asks, as a statement that should be true
  outcome result = outcome::not_applicable;
  std::string reason;       ///< what was seen where it failed, why not where it does not apply
  std::uint64_t looks = 0;  ///< how often it was looked at
};

/// A number that was measured.
struct figure {
  std::string name;
  double value;
  std::string unit;
};

/// Every check there is, in the order of the report. A check that nobody looked at is not applicable, with its reason,
/// never passed.
class ledger {
 public:
  ledger();

  /// One look at `check`. The first failure stays. `what` is called for its text only where it failed.
  template <class Text>
  bool look(std::string_view check, bool good, Text&& what) {
    check_result& c = find(check);
    ++c.looks;
    if (c.result == outcome::failed) return good;
    if (good) {
      c.result = outcome::passed;
    } else {
      c.result = outcome::failed;
      c.reason = std::string(what()) + " (during " + stage_ + ")";
    }
    return good;
  }
  /// Why a check does not apply, if it turns out that nobody looked.
  void skip(std::string_view check, std::string_view why);
  void skip_rest(std::string_view why);

  void measured(std::string name, double value, std::string unit);

  /// What the kit is doing, for the text of failures.
  void begin(std::string_view stage) { stage_ = stage; }
  [[nodiscard]] const std::string& stage() const noexcept { return stage_; }

  [[nodiscard]] const std::vector<check_result>& checks() const noexcept { return checks_; }
  [[nodiscard]] const std::vector<figure>& figures() const noexcept { return figures_; }
  [[nodiscard]] bool failed() const noexcept;

 private:
  [[nodiscard]] check_result& find(std::string_view check);

  std::vector<check_result> checks_;
  std::vector<figure> figures_;
  std::string stage_ = "start";
};

}  // namespace asperity::conformance
