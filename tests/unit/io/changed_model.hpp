// The file of a model with one thing changed in it, and materials to write into one.
#pragma once

#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "asperity/model/material.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "unit/control/drawn.hpp"

namespace asperity::test_support {

/// A model as the writer leaves it, for a test to change and to read again.
struct changed_model {
  scratch_folder folder;
  glb_editor glb;

  explicit changed_model(const textured_model& model) : glb(written(folder, model)) {}

  [[nodiscard]] result<textured_model> load() const {
    std::ofstream(folder.file("changed.glb"), std::ios::binary) << glb.bytes();
    return io::load_textured_model(folder.file("changed.glb"));
  }
  /// Expects an error that says so.
  void expect_refused(const std::string& why) const {
    const result<textured_model> read = load();
    ASSERT_FALSE(read) << why;
    EXPECT_NE(read.error().message.find(why), std::string::npos) << read.error().message;
  }

 private:
  [[nodiscard]] static std::string written(const scratch_folder& folder, const textured_model& model) {
    EXPECT_TRUE(io::save_textured_model(model, folder.file("m.glb")));
    return read_all(folder.file("m.glb"));
  }
};

/// A material within all ranges.
[[nodiscard]] inline material drawn_material(std::string name, drawn& d) {
  material m{std::move(name),          d.log_between(100.0, 1e7), d.between(0.0, 100.0), d.between(0.0, 10.0), 0.0,
             friction_combine::average};
  m.dynamic_friction = m.static_friction * d.between(0.0, 1.0);
  m.combine = static_cast<friction_combine>(d.bits() % 4);
  return m;
}

inline void expect_same(const material& a, const material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.stiffness_n_per_m, b.stiffness_n_per_m);
  EXPECT_EQ(a.dissipation_s_per_m, b.dissipation_s_per_m);
  EXPECT_EQ(a.static_friction, b.static_friction);
  EXPECT_EQ(a.dynamic_friction, b.dynamic_friction);
  EXPECT_EQ(a.combine, b.combine);
}

}  // namespace asperity::test_support
