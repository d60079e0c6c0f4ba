// The real meshes at 16 cm from corner to corner, with what support/bake_real_meshes.cmake made of them.
#pragma once

#include <array>
#include <string>

#include "law/oracle/against_originals.hpp"

namespace asperity::oracle {

struct real_mesh {
  const char* file;
  std::size_t triangles;
  std::size_t holes;
};
inline constexpr real_mesh igea{"igea.ply", 268'686, 0};
inline constexpr real_mesh rocker_arm{"rocker-arm.obj", 20'088, 0};
inline constexpr real_mesh bunny{"stanford-bunny.obj", 69'451, 5};
inline constexpr std::array real_meshes{igea, rocker_arm, bunny};

/// Why the tests have to be skipped; empty where all real meshes are there.
[[nodiscard]] std::string why_without_real_meshes();
/// The command's report of a bake, as JSON. @throws std::runtime_error where there is none
[[nodiscard]] std::string bake_report_of(const real_mesh& mesh);
/// The mesh as the bake took it, its holes closed, and the bake. Read once per program.
/// @throws std::runtime_error where one of them cannot be read
[[nodiscard]] const original_and_bake& load_real_body(const std::string& name);

}  // namespace asperity::oracle
