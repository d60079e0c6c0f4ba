// Takes a .glb apart into JSON and bytes and puts it together again, so that a test can plant one fault and no other.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace asperity::test_support {

struct glb_editor {
  nlohmann::json json;
  std::string bin;

  explicit glb_editor(std::string_view bytes) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    json = nlohmann::json::parse(bytes.substr(20, length));
    bin = bytes.substr(28 + length);
  }

  [[nodiscard]] std::string bytes() const { return bytes(json.dump()); }

  /// With a JSON chunk of the caller's own.
  [[nodiscard]] std::string bytes(std::string text) const {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    const auto word = [&](std::size_t w) {
      const auto v = static_cast<std::uint32_t>(w);
      out.append(reinterpret_cast<const char*>(&v), 4);
    };
    word(2);
    word(12 + 8 + text.size() + 8 + bin.size());
    word(text.size());
    out += "JSON" + text;
    word(bin.size());
    out += std::string("BIN\0", 4) + bin;
    return out;
  }

  /// The bytes that a buffer view begins with, as numbers of type T.
  template <class T>
  void put(std::size_t view, std::size_t index, T value) {
    std::memcpy(bin.data() + json["bufferViews"][view].value("byteOffset", std::size_t{0}) + index * sizeof(T), &value,
                sizeof(T));
  }

  [[nodiscard]] nlohmann::json& haptic() { return json["meshes"][0]["extensions"]["ASPERITY_mesh_haptic_texture"]; }
};

}  // namespace asperity::test_support
