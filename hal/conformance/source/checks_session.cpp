#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "checks.hpp"

namespace asperity::conformance {
namespace {

double median_us(std::vector<std::int64_t> times_ns) {
  if (times_ns.empty()) return 0.0;
  const auto middle = times_ns.begin() + static_cast<std::ptrdiff_t>(times_ns.size() / 2);
  std::nth_element(times_ns.begin(), middle, times_ns.end());
  return 1e-3 * static_cast<double>(*middle);
}

// How evenly measurements arrive.
class intervals {
 public:
  void add(double ms) noexcept {
    ++n_;
    const double d = ms - mean_;
    mean_ += d / static_cast<double>(n_);
    squares_ += d * (ms - mean_);
    largest_ = std::max(largest_, ms);
  }
  [[nodiscard]] double deviation_ms() const noexcept {
    return n_ > 1 ? std::sqrt(squares_ / static_cast<double>(n_ - 1)) : 0.0;
  }
  [[nodiscard]] double largest_ms() const noexcept { return largest_; }

 private:
  std::uint64_t n_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;
  double largest_ = 0.0;
};

}  // namespace

void check_session(subject& device, ledger& found, const session_length& length) {
  found.begin("the session");
  if (!device.reach(device_state::ready)) return;
  static_cast<void>(device.tick({}));

  const std::int64_t begin_ns = device.clock().now_ns();
  const asperity_sample first = device.newest();
  asperity_sample last = first;
  std::uint64_t fresh = 0;
  intervals between;
  device.measure_pairs(true);
  for (int i = 0; i < length.ticks; ++i) {
    if (i == length.ticks / 2) {
      found.begin("the armed half of the session");
      if (!device.reach(device_state::armed)) break;
    }
    wrench w{};
    if (device.may_push && i >= length.ticks / 2) {
      const double s = std::sin(0.05 * i);  // comes and goes, so that armed and active follow each other
      w = std::max(0.0, s) * device.small_wrench();
    }
    static_cast<void>(device.tick(w));
    if (i % 7 == 0) static_cast<void>(device.read());  // asked again at once: most devices have nothing new
    if (device.newest().sequence != last.sequence) {
      ++fresh;
      between.add(1e-6 * static_cast<double>(device.newest().host_time_ns - last.host_time_ns));
      last = device.newest();
    }
    if (i % 100 == 0) device.look_at_capabilities();
  }
  device.measure_pairs(false);
  const double seconds = 1e-9 * static_cast<double>(device.clock().now_ns() - begin_ns);
  if (!(seconds > 0.0)) return;

  const asperity_capabilities& c = device.capabilities();
  const double rate = static_cast<double>(fresh) / seconds;
  const double least = c.minimum_rate_hz > 0.0 ? c.minimum_rate_hz : 0.5 * c.nominal_rate_hz;
  found.look("timing.rate", rate >= 0.99 * least,
             [&] { return std::to_string(rate) + " new samples per second, of " + std::to_string(least); });
  const double pair_us = median_us(device.pair_times_ns());
  const double half_us = 0.5e-3 * static_cast<double>(device.period_ns());
  found.look("timing.calls_fit_the_period", pair_us < half_us, [&] {
    return "a read() and a write() take " + std::to_string(pair_us) + " us in the median; half a period is " +
           std::to_string(half_us) + " us";
  });
  if (c.worst_latency_ns == 0 || !(c.minimum_rate_hz > 0.0)) {
    found.skip("timing.age", "the driver states no worst latency, or no minimum rate");
  }
  found.skip("samples.new_is_new", "the device has no clock of its own");
  found.skip("samples.same_sequence_same_sample", "every read() had something new");

  found.measured("session_s", seconds, "s");
  found.measured("new_samples_per_s", rate, "Hz");
  found.measured("samples_lost", static_cast<double>(last.lost - std::min(first.lost, last.lost)), "");
  found.measured("interval_deviation", between.deviation_ms(), "ms");
  found.measured("interval_longest", between.largest_ms(), "ms");
  found.measured("read_and_write_median", pair_us, "us");
  const std::vector<std::int64_t>& pairs = device.pair_times_ns();
  if (!pairs.empty()) {
    found.measured("read_and_write_longest", 1e-3 * static_cast<double>(*std::max_element(pairs.begin(), pairs.end())),
                   "us");
  }
}

}  // namespace asperity::conformance
