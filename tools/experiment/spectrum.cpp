#include "spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

namespace asperity::experiment {
namespace {

constexpr double cycle_rad = 2.0 * std::numbers::pi;
constexpr std::size_t lines_per_band = 5;

// Edge of a band; the last one's upper edge is bands.bands.
double edge_per_m(double edge, const band_settings& b) {
  return b.lowest_per_m * std::pow(b.highest_per_m / b.lowest_per_m, edge / static_cast<double>(b.bands));
}

double squared_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace

double band_frequency(std::size_t band, const band_settings& bands) {
  return edge_per_m(static_cast<double>(band) + 0.5, bands);
}

std::vector<double> band_spectrum(const std::vector<double>& x_m, const std::vector<double>& values,
                                  const band_settings& bands) {
  std::vector<double> out(bands.bands, 0.0);
  if (values.size() < 3) return out;
  const auto [low, high] = std::minmax_element(x_m.begin(), x_m.end());
  const double from = *low, length = *high - *low;
  if (!(length > 0.0)) return out;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  std::vector<double> weighted(values.size(), 0.0);
  double window_power = 0.0;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double step = 0.5 * std::fabs(x_m[i + 1] - x_m[i - 1]);
    const double hann = 0.5 - 0.5 * std::cos(cycle_rad * (x_m[i] - from) / length);
    weighted[i] = (values[i] - mean) * hann * step;
    window_power += hann * hann * step;
  }
  for (std::size_t b = 0; b < bands.bands; ++b) {
    double power = 0.0;
    const double width = edge_per_m(static_cast<double>(b) + 1.0, bands) - edge_per_m(static_cast<double>(b), bands);
    for (std::size_t k = 0; k < lines_per_band; ++k) {
      const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(lines_per_band);
      const double f = edge_per_m(static_cast<double>(b) + share, bands);
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < weighted.size(); ++i) sum += weighted[i] * std::polar(1.0, -cycle_rad * f * x_m[i]);
      power += 2.0 * std::norm(sum) / window_power;  // power density, both sides of zero
    }
    out[b] = std::sqrt(power / static_cast<double>(lines_per_band) * width);
  }
  return out;
}

std::vector<std::vector<std::size_t>> confusion(const std::vector<felt_sample>& samples, std::size_t classes) {
  std::vector<std::vector<std::size_t>> out(classes, std::vector<std::size_t>(classes, 0));
  for (const felt_sample& unknown : samples) {
    double nearest = std::numeric_limits<double>::max();
    std::size_t taken_for = 0;
    for (std::size_t c = 0; c < classes; ++c) {
      std::vector<double> mean(unknown.features.size(), 0.0);
      double count = 0.0;
      for (const felt_sample& s : samples) {
        if (s.is != c || (c == unknown.is && s.group == unknown.group)) continue;
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += s.features[i];
        count += 1.0;
      }
      if (!(count > 0.0)) continue;
      for (double& m : mean) m /= count;
      const double d = squared_distance(unknown.features, mean);
      if (d < nearest) {
        nearest = d;
        taken_for = c;
      }
    }
    ++out[unknown.is][taken_for];
  }
  return out;
}

}  // namespace asperity::experiment
