// A program of a consumer of the compiled components: a tetrahedron is saved, read back and baked.
#include <cstdio>

#include <asperity/bake/bake.hpp>
#include <asperity/io/mesh_file.hpp>
#include <asperity/io/textured_model_file.hpp>

namespace {

int fail(const asperity::error& e) {
  std::fprintf(stderr, "%s: %s\n", asperity::to_string(e.code), e.message.c_str());
  return 1;
}

}  // namespace

int main() {
  asperity::triangle_mesh solid;
  solid.positions = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.0, 0.1, 0.0}, {0.0, 0.0, 0.1}};
  solid.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  if (const auto saved = asperity::io::save_ply(solid, "solid.ply"); !saved) return fail(saved.error());
  const auto mesh = asperity::io::load_mesh("solid.ply");
  if (!mesh) return fail(mesh.error());

  asperity::bake::bake_settings options;
  options.coarse = *mesh;
  options.texture_size = 64;
  const auto model = asperity::bake::bake(*mesh, options);
  if (!model) return fail(model.error());
  if (const auto saved = asperity::io::save_textured_model(*model, "solid.glb"); !saved) return fail(saved.error());
  const auto again = asperity::io::load_textured_model("solid.glb");
  if (!again) return fail(again.error());

  std::printf("%zu coarse triangles, volume %g m^3\n", again->mesh.triangles.size(), again->mass.volume_m3);
  return again->mesh.triangles.size() == 4 ? 0 : 1;
}
