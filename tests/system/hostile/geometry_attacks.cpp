// Counts, offsets, indices and numbers that lie.
#include <cmath>
#include <cstring>
#include <limits>

#include "attacks.hpp"

namespace asperity::hostile {
namespace {

using nlohmann::json;
using test_support::glb_editor;
namespace fs = std::filesystem;

using edit = std::function<void(json& document, std::string& bin)>;

/// An edit of the plain tetrahedron, as a .glb and as a .gltf with its bytes beside it.
void add_mesh(std::vector<attack>& out, const std::string& name, const std::string& says, const edit& change,
              const std::string& model_says = "") {
  const auto made = [change] {
    std::pair<json, std::string> file{tetrahedron(), tetrahedron_bytes()};
    change(file.first, file.second);
    return file;
  };
  out.push_back({name + ".glb", "a.glb", says, model_says.empty() ? says : model_says, [made](const fs::path& f) {
                   const auto [document, bin] = made();
                   write(f / "a.glb", glb(document, bin));
                 }});
  out.push_back({name + ".gltf", "a.gltf", says, no_glb, [made](const fs::path& f) {
                   auto [document, bin] = made();
                   document["buffers"][0]["uri"] = "data.bin";
                   write(f / "data.bin", bin);
                   write(f / "a.gltf", document.dump());
                 }});
}

/// An edit of a good textured model.
void add_model(std::vector<attack>& out, const std::string& name, const std::string& says,
               const std::function<void(glb_editor&)>& change, const std::string& mesh_says = "") {
  out.push_back({name, "a.glb", mesh_says, says, [change](const fs::path& f) {
                   glb_editor model(good_model());
                   change(model);
                   write(f / "a.glb", model.bytes());
                 }});
}

template <class T>
void put(std::string& bin, std::size_t at, T value) {
  std::memcpy(bin.data() + at, &value, sizeof value);
}

json nodes_in_a_chain(std::size_t count) {
  json nodes = json::array();
  for (std::size_t n = 0; n + 1 < count; ++n) nodes.push_back({{"children", {n + 1}}});
  nodes.push_back({{"mesh", 0}});
  return nodes;
}

void add_ranges(std::vector<attack>& out) {
  add_mesh(out, "A7_count_2_to_60",
           "accessors[0] (count 1152921504606846976) lies outside its bufferView of 48 bytes; ",
           [](json& d, std::string&) { d["accessors"][0]["count"] = 1ULL << 60; });
  add_mesh(out, "count_one_too_many", "accessors[0] (count 5) lies outside its bufferView of 48 bytes; ",
           [](json& d, std::string&) { d["accessors"][0]["count"] = 5; });
  add_mesh(out, "count_negative", "accessors[0].count is not a whole number from 0; ",
           [](json& d, std::string&) { d["accessors"][0]["count"] = -4; });
  add_mesh(out, "count_0", "accessors[0] (count 0) lies outside",
           [](json& d, std::string&) { d["accessors"][0]["count"] = 0; });
  add_mesh(out, "A8_view_offset_wraps", "bufferViews[0] lies outside its buffer of 96 bytes; ",
           [](json& d, std::string&) { d["bufferViews"][0]["byteOffset"] = 18446744073709551608U; });
  add_mesh(out, "accessor_offset_wraps", "accessors[0] (count 4) lies outside",
           [](json& d, std::string&) { d["accessors"][0]["byteOffset"] = 18446744073709551608U; });
  add_mesh(out, "view_length_2_to_63", "bufferViews[1] lies outside",
           [](json& d, std::string&) { d["bufferViews"][1]["byteLength"] = 1ULL << 63; });
  add_mesh(out, "stride_below_the_element", "accessors[0] (count 4) lies outside",
           [](json& d, std::string&) { d["bufferViews"][0]["byteStride"] = 4; });
  add_mesh(out, "stride_7", "bufferViews[0].byteStride is not a multiple of 4 up to 252; ",
           [](json& d, std::string&) { d["bufferViews"][0]["byteStride"] = 7; });
  add_mesh(out, "buffer_length_2_to_64", "buffers[0].byteLength is 18446744073709551615, but there are 96 bytes; ",
           [](json& d, std::string&) { d["buffers"][0]["byteLength"] = 18446744073709551615U; });
  add_mesh(out, "sparse_accessor", "accessors[0] is sparse or has no bufferView; export it as plain data",
           [](json& d, std::string&) {
             d["accessors"][0]["sparse"] = {{"count", 1ULL << 40}, {"indices", {{"bufferView", 0}}}};
           });
  add_mesh(out, "no_bufferView", "accessors[0] is sparse or has no bufferView; ",
           [](json& d, std::string&) { d["accessors"][0].erase("bufferView"); });
  add_mesh(out, "type_unknown", "accessors[0] has a component type or type that glTF does not know for vertices; ",
           [](json& d, std::string&) { d["accessors"][0]["type"] = "MAT9"; });
}

void add_indices(std::vector<attack>& out) {
  add_mesh(
      out, "A13_index_2147483647", "accessors[1] entry 4 names vertex 2147483647 of 4; ",
      [](json&, std::string& bin) { put(bin, 48 + 16, std::uint32_t{2147483647}); }, never_baked);
  const auto dangling = [&](const char* name, const char* says, const char* pointer) {
    add_mesh(out, name, says, [pointer](json& d, std::string&) { d[json::json_pointer(pointer)] = 2147483647; });
  };
  dangling("A8_node_names_no_mesh", "nodes[0].mesh is 2147483647, but there are only 1; ", "/nodes/0/mesh");
  dangling("A8_accessor_names_no_view", "accessors[0].bufferView is 2147483647, but there are only 2; ",
           "/accessors/0/bufferView");
  dangling("A8_view_names_no_buffer", "bufferViews[0].buffer is 2147483647, but there are only 1; ",
           "/bufferViews/0/buffer");
  dangling("A8_mesh_names_no_accessor", "POSITION is 2147483647, but there are only 2; ",
           "/meshes/0/primitives/0/attributes/POSITION");
  dangling("A8_no_such_scene", "the document.scene is 2147483647, but there are only 1; ", "/scene");
  dangling("A8_scene_names_no_node", "scenes[0].nodes names something other than one of the 1 nodes; ",
           "/scenes/0/nodes/0");
  dangling("A8_no_such_indices", "indices is 2147483647, but there are only 2; ", "/meshes/0/primitives/0/indices");
  add_mesh(out, "index_minus_1", "nodes[0].mesh is not a whole number from 0; ",
           [](json& d, std::string&) { d["nodes"][0]["mesh"] = -1; });
}

void add_numbers(std::vector<attack>& out) {
  for (const auto& [name, value] : {std::pair{"NaN", std::nanf("")}, std::pair{"infinity", INFINITY}}) {
    add_mesh(
        out, std::string("A13_position_") + name, "accessors[0] has a coordinate that is not finite at vertex 1; ",
        [v = value](json&, std::string& bin) { put(bin, 16, v); }, never_baked);
  }
  const auto set_x = [](glb_editor& g, float x) {
    // Every position of coarse vertex 0, and then some: the first attribute triple of each corner at that vertex.
    for (std::size_t i = 0; i < 24; ++i) {
      std::uint32_t vertex = 0;
      std::memcpy(&vertex, g.bin.data() + g.json["bufferViews"][4]["byteOffset"].get<std::size_t>() + 4 * i, 4);
      if (vertex == 0) g.put(0, 3 * i, x);
    }
  };
  add_model(
      out, "position_NaN", "has a coordinate that is not finite at vertex ",
      [=](glb_editor& g) { set_x(g, std::nanf("")); }, "has a coordinate that is not finite at vertex ");
  // A plain mesh may be in any unit; a bake asks for its size. In a model the unit is the metre.
  add_model(out, "position_1e30", "vertex 0 of the coarse mesh has a coordinate that is not finite or beyond 10 km; ",
            [=](glb_editor& g) { set_x(g, -1e30F); });
  add_model(out, "texel_NaN", " is not a position (NaN, infinite or beyond 10 km); ",
            [](glb_editor& g) { g.put(5, 3 * (24 * 4 + 4), std::nanf("")); });
  add_model(out, "texel_1e30", " is not a position (NaN, infinite or beyond 10 km); ",
            [](glb_editor& g) { g.put(5, 3 * (24 * 4 + 4), 1e30F); });
  add_model(out, "report_as_text", "report.rms_error_m is not a finite number; ",
            [](glb_editor& g) { g.haptic()["report"]["rms_error_m"] = "NaN"; });
  add_mesh(out, "matrix_of_17", "nodes[0].matrix does not hold 16 finite numbers; ",
           [](json& d, std::string&) { d["nodes"][0]["matrix"] = json(17, 1.0); });
  add_mesh(out, "scale_of_words", "nodes[0].scale does not hold 3 finite numbers; ", [](json& d, std::string&) {
    d["nodes"][0]["scale"] = {"1", "1", "1"};
  });
  add_mesh(
      out, "scale_beyond_numbers", "is moved beyond all numbers by its node; ",
      [](json& d, std::string&) {
        d["nodes"][0]["scale"] = {1e308, 1e308, 1e308};
        d["nodes"][0]["translation"] = {1e308, 1e308, 1e308};
      },
      never_baked);
}

void add_scenes(std::vector<attack>& out) {
  add_mesh(
      out, "node_below_itself", "nodes[0] has two parents or is its own ancestor; ",
      [](json& d, std::string&) { d["nodes"][0]["children"] = {0}; }, never_baked);
  add_mesh(
      out, "cycle_of_3_nodes", "nodes[0] has two parents or is its own ancestor; ",
      [](json& d, std::string&) {
        d["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"children", {0}}, {"mesh", 0}}};
      },
      never_baked);
  add_mesh(
      out, "diamond_of_nodes", "nodes[3] has two parents or is its own ancestor; ",
      [](json& d, std::string&) {
        d["nodes"] = {{{"children", {1, 2}}}, {{"children", {3}}}, {{"children", {3}}}, {{"mesh", 0}}};
      },
      never_baked);
  // Deep is no fault where nothing recurses; it only has to end.
  out.push_back({"chain_of_30000_nodes", "a.glb", "", never_baked, [](const fs::path& f) {
                   json d = tetrahedron();
                   d["nodes"] = nodes_in_a_chain(30'000);
                   write(f / "a.glb", glb(d, tetrahedron_bytes()));
                 }});
  out.push_back({"60_million_triangles_placed", "a.glb",
                 "places more than 8 million triangles or vertices in its scene; ", never_baked, [](const fs::path& f) {
                   json d = tetrahedron();
                   std::string bin(3 * 12 * 12000, '\0');
                   d["buffers"][0]["byteLength"] = bin.size();
                   d["bufferViews"] = {{{"buffer", 0}, {"byteLength", bin.size()}}};
                   d["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 36000}, {"type", "VEC3"}}};
                   d["meshes"][0]["primitives"][0].erase("indices");
                   d["nodes"] = json(5000, {{"mesh", 0}});
                   for (int n = 1; n < 5000; ++n) d["scenes"][0]["nodes"].push_back(n);
                   write(f / "a.glb", glb(d, bin));
                 }});
}

void add_extension(std::vector<attack>& out) {
  add_model(out, "texture_larger_than_its_bytes",
            "texture.bufferView holds 6912 bytes, not the 3221225472 of 16384 x 16384 texels; ",
            [](glb_editor& g) { g.haptic()["texture"]["width"] = g.haptic()["texture"]["height"] = 16384; });
  add_model(out, "texture_of_2_to_32", "texture is 24 x 4294967296 texels, and both must be 1 to 16384; ",
            [](glb_editor& g) { g.haptic()["texture"]["height"] = 4294967296U; });
  add_model(out, "texture_names_no_view", "texture.bufferView is 2147483647, but there are only ",
            [](glb_editor& g) { g.haptic()["texture"]["bufferView"] = 2147483647; });
  add_model(out, "pieces_of_2_to_32_vertices", "pieces.table row 0 takes more than the arrays hold; ",
            [](glb_editor& g) { g.put(6, 0, std::uint32_t{0xffffffff}); });
  // Small numbers that would take many times their size in memory. One view of 48 MiB stands for every array.
  const auto inflate = [](glb_editor& g) {
    g.json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", g.bin.size()}, {"byteLength", std::size_t{48} << 20}});
    g.bin.resize(g.bin.size() + (std::size_t{48} << 20));
    g.json["buffers"][0]["byteLength"] = g.bin.size();
    return g.json["bufferViews"].size() - 1;
  };
  add_model(out, "12_million_pieces_of_nothing",
            "pieces.table has 50331648 bytes, more than the 192 that the pieces of 12 triangles can take; ",
            [=](glb_editor& g) { g.haptic()["pieces"]["table"] = inflate(g); });
  add_model(
      out, "16_million_triangles_of_bytes",
      "the mesh has 16777216 triangles and 24 vertices, more than the limit of 1000000 triangles with three ",
      [=](glb_editor& g) {
        g.json["accessors"][2] = {
            {"bufferView", inflate(g)}, {"componentType", 5121}, {"count", std::size_t{48} << 20}, {"type", "SCALAR"}};
      },
      "places more than 8 million triangles or vertices in its scene; ");
  add_model(
      out, "24_million_texture_coordinates_of_bytes",
      "the mesh has 24 positions, 25165824 texture coordinates, 24 entries and 8 vertices in ",
      [=](glb_editor& g) {
        g.json["accessors"][1] = {{"bufferView", inflate(g)},
                                  {"componentType", 5121},
                                  {"normalized", true},
                                  {"count", std::size_t{24} << 20},
                                  {"type", "VEC2"}};
      },
      "has 25165824 texture coordinates for 24 vertices; ");
  add_model(out, "triangle_without_area", "coarse triangle 0 has no area; ", [](glb_editor& g) {
    g.put(2, 0, std::uint32_t{22});  // a vertex that the triangle has already
  });
}

}  // namespace

std::vector<attack> geometry_attacks() {
  std::vector<attack> out;
  add_ranges(out);
  add_indices(out);
  add_numbers(out);
  add_scenes(out);
  add_extension(out);
  return out;
}

}  // namespace asperity::hostile
