// What the depths of many contacts cost on each backend. In builds with OpenGL.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "gpu_use.hpp"
#include "plane_times.hpp"
#include "progress.hpp"

namespace asperity::command {

struct backend_bench {
  std::string backend = "all";  ///< or gl-compute, gl-occlusion: the one to compare with the CPU
  std::optional<std::string> gpu;
  std::uint32_t grid = 64;
  std::size_t repeats = 10;
  std::uint64_t seed = 1;
};

/// Times of one number of contacts, on the wall: a GPU does not spend CPU time.
struct contacts_timed {
  std::size_t contacts = 0;
  std::size_t calls = 1;         ///< that they were measured in
  std::size_t device_bytes = 0;  ///< of a backend with room for so many, beyond the models
  std::vector<double> seconds;
  double cpu_ratio = 1.0;  ///< of the medians, to the CPU backend with the same settings in the same run
};

/// One backend with one gradient.
struct backend_times {
  std::string backend, gradient, lookup;
  double set_up_s = 0.0;                  ///< uploads and what the driver compiles at once
  double first_tick_s = 0.0;              ///< with what it compiles late
  std::vector<contacts_timed> ticks{};    ///< of one call for all contacts
  std::optional<contacts_timed> batch{};  ///< of pairs with poses of their own; the CPU one by one
};

struct bench_of_backends {
  gpu_use gpu;                      ///< its device_bytes: the models
  std::size_t patch_triangles = 0;  ///< of both patches of the contact that is repeated
  std::vector<backend_times> backends;
  std::vector<bench_of_planes> planes;  ///< of the default renderer; none where only gl-occlusion is compared
};

/// Repeats the deepest contact at the first touch, and times all backends in turn, so that what else the machine does
/// falls on all alike.
/// @return unsupported (no GPU) | invalid_argument (nothing is touched) | cancelled | what the backends' makers say
[[nodiscard]] result<bench_of_backends> time_backends(const scene& bodies, const backend_bench& options,
                                                      progress_line& progress);

}  // namespace asperity::command
