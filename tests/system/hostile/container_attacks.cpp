// Wrong envelopes, and JSON that exhausts or misleads its parser.
#include <cstring>

#include "attacks.hpp"

namespace asperity::hostile {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A .glb whose bytes are the same for both readers.
attack of_bytes(std::string name, std::string says, std::function<std::string()> bytes) {
  return {std::move(name), "a.glb", says, says,
          [bytes = std::move(bytes)](const fs::path& f) { write(f / "a.glb", bytes()); }};
}

void put_word(std::string& bytes, std::size_t offset, std::uint32_t value) {
  std::memcpy(bytes.data() + offset, &value, 4);
}

std::uint32_t json_length(const std::string& bytes) {
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  return length;
}

/// The same JSON text as a .glb and as a .gltf.
void add_text(std::vector<attack>& out, const std::string& name, const std::string& says,
              const std::function<std::string()>& text) {
  out.push_back(of_bytes(name + ".glb", says, [text] { return glb(text(), tetrahedron_bytes()); }));
  out.push_back({name + ".gltf", "a.gltf", says, no_glb, [text](const fs::path& f) { write(f / "a.gltf", text()); }});
}

std::string with_extras(const std::string& extras) {
  return "{\"extras\":" + extras + "," + tetrahedron().dump().substr(1);
}

std::string repeated(const std::string& item, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += (i == 0 ? "" : ",") + item;
  return out;
}

}  // namespace

std::vector<attack> container_attacks() {
  std::vector<attack> out;
  out.push_back(of_bytes("A1_image_far_away", "the document.bufferViews[2] lies outside its buffer of 96 bytes; ", [] {
    json d = tetrahedron();
    d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 0xffffff0000U}, {"byteLength", 100}});
    d["images"] = {{{"bufferView", 2}, {"mimeType", "image/png"}}};
    return glb(d, tetrahedron_bytes());
  }));
  out.push_back(
      of_bytes("A2b_image_past_the_end", "the document.bufferViews[2] lies outside its buffer of 96 bytes; ", [] {
        json d = tetrahedron();
        d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 100000}});
        d["images"] = {{{"bufferView", 2}, {"mimeType", "image/png"}}};
        std::string bin = tetrahedron_bytes();
        bin.replace(60, 8, "\x89PNG\r\n\x1a\n");
        return glb(d, bin);
      }));
  out.push_back(of_bytes("A3_BIN_8_bytes_too_long", "begins no BIN chunk that fits the file; ", [] {
    std::string bytes = glb(tetrahedron(), tetrahedron_bytes());
    put_word(bytes, 20 + json_length(bytes), 96 + 8);
    return bytes;
  }));
  out.push_back(of_bytes("A4_byteLength_0", "buffers[0].byteLength is 0, but there are 0 bytes; ", [] {
    std::string bytes = glb(std::string(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":0}]})"), "");
    return bytes;
  }));
  for (const std::size_t depth : {10'000U, 100'000U}) {
    add_text(out, "A5_extras_nested_" + std::to_string(depth),
             "nests its JSON deeper than 32 levels at byte 41 of it; ",
             [depth] { return with_extras(std::string(depth, '[') + std::string(depth, ']')); });
  }
  add_text(out, "objects_nested", "nests its JSON deeper than 32 levels at byte ", [] {
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += R"({"a":)";
    return with_extras(deep + "1" + std::string(5000, '}'));
  });
  add_text(out, "A11_2_million_nodes", "holds more than 200000 JSON items, the last at byte ",
           [] { return R"({"asset":{"version":"2.0"},"nodes":[)" + repeated("{}", 2'000'000) + "]}"; });
  out.push_back(of_bytes("JSON_of_17_MiB", " bytes of JSON, more than the limit of 16777216; ", [] {
    std::string quoted((17U << 20) + 2, 'x');
    quoted.front() = quoted.back() = '"';
    return glb(with_extras(quoted), tetrahedron_bytes());
  }));
  add_text(out, "name_twice", "holds JSON with the name 'byteLength' twice in one object; ", [] {
    return std::string(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"byteLength":99999}]})");
  });
  add_text(out, "name_twice_in_other_letters", "with the name 'asset' twice in one object; ",
           [] { return std::string(R"({"asset":{"version":"2.0"},"\u0061sset":{}})"); });
  add_text(out, "invalid_UTF8", "holds JSON that does not parse: byte 14 of it is wrong; ",
           [] { return with_extras("\"ab\xff\xfe\""); });
  add_text(out, "overlong_UTF8", "holds JSON that does not parse: byte ", [] { return with_extras("\"\xc0\xaf\""); });
  add_text(out, "lone_surrogate", "holds JSON that does not parse: byte ", [] { return with_extras(R"("\ud800")"); });
  add_text(out, "number_1e999", "does not parse: a number in it is too large; ", [] { return with_extras("1e999"); });
  add_text(out, "NaN_as_a_word", "holds JSON that does not parse: byte 11 of it is wrong; ",
           [] { return with_extras("NaN"); });
  add_text(out, "text_behind_the_end", "holds JSON that does not parse: byte ",
           [] { return tetrahedron().dump() + "}"; });
  add_text(out, "closing_first", "holds JSON that does not parse: byte 1 of it is wrong; ",
           [] { return std::string(50'000, ']') + std::string(50'000, '['); });
  add_text(out, "an_array", "does not parse as an object; ", [] { return "[1" + std::string(40, ' ') + "]"; });
  out.push_back({"nul_in_the_JSON.glb", "a.glb", "holds JSON that does not parse: byte ", "does not parse: byte ",
                 [](const fs::path& f) { write(f / "a.glb", glb(std::string("{\"a\0b\":1}", 9), "")); }});
  add_text(out, "words_of_control_characters", "requires the extension '????[3mxxx", [] {
    json d = tetrahedron();
    d.erase("buffers");
    d["extensionsRequired"] = {"\n\r\t\x1b[3m" + std::string(100'000, 'x')};
    return d.dump();
  });
  out.push_back({"99000_nodes_within_the_limit", "a.glb", "holds no faces; ", never_baked, [](const fs::path& f) {
                   write(f / "a.glb",
                         glb(R"({"asset":{"version":"2.0"},"nodes":[)" + repeated("{}", 99'000) + "]}", ""));
                 }});
  out.push_back({"sparse_300_MiB", "a.glb", "holds 314572800 bytes of JSON, more than the limit of 134217728; ",
                 "has 314572800 bytes, more than the limit of 268435456; reduce it first", [](const fs::path& f) {
                   write(f / "a.glb", "");
                   fs::resize_file(f / "a.glb", 300U << 20);
                 }});
  return out;
}

}  // namespace asperity::hostile
