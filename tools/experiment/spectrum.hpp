// Spectra of what is felt over the place, and textures told apart by them.
#pragma once

#include <cstddef>
#include <vector>

namespace asperity::experiment {

/// Power of values over a way, in bands of spatial frequency that grow by equal factors. The values may be unevenly
/// spaced: a hand is. A Hann window over the way, so that its ends make no lines of their own.
struct band_settings {
  double lowest_per_m = 150.0;
  double highest_per_m = 3000.0;
  std::size_t bands = 36;
};

/// Root of the power in each band, in the values' unit. @pre x_m and values of one length; x_m runs one way, more or
/// less
[[nodiscard]] std::vector<double> band_spectrum(const std::vector<double>& x_m, const std::vector<double>& values,
                                                const band_settings& bands = {});

/// Middle of a band, 1/m.
[[nodiscard]] double band_frequency(std::size_t band, const band_settings& bands = {});

/// Something felt once: which class it belongs to, which group must not help to recognise it, and its features.
struct felt_sample {
  std::size_t is = 0;
  std::size_t group = 0;
  std::vector<double> features;
};

/// How often a sample of class i was taken for class j. Each is given to the class whose mean, without the samples of
/// its own group, is nearest.
[[nodiscard]] std::vector<std::vector<std::size_t>> confusion(const std::vector<felt_sample>& samples,
                                                              std::size_t classes);

}  // namespace asperity::experiment
