#include "gltf_guard.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <set>
#include <string>

#include "file_bytes.hpp"

namespace asperity::io {
namespace {

constexpr std::uint32_t magic_gltf = 0x46546c67;
constexpr std::uint32_t chunk_json = 0x4e4f534a;
constexpr std::uint32_t chunk_bin = 0x004e4942;
constexpr std::size_t header_bytes = 12;
constexpr std::size_t chunk_header_bytes = 8;

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  return load_number<std::uint32_t>(bytes.data() + offset);
}

std::size_t component_bytes(std::uint64_t component_type) noexcept {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::size_t component_count(std::string_view type) noexcept {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

/// Extensions that a document may require without changing its geometry.
bool leaves_geometry_alone(std::string_view extension) {
  constexpr std::array<std::string_view, 5> prefixes{"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_",
                                                     "MSFT_texture_"};
  return std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view p) { return extension.starts_with(p); });
}

class geometry_checker {
 public:
  geometry_checker(const json& document, const std::vector<std::size_t>& buffer_bytes)
      : root_(document, "the document"), buffer_bytes_(buffer_bytes) {}

  json check() {
    check_asset();
    json out;
    out["asset"] = {{"version", "2.0"}};
    out["bufferViews"] = views();
    used_.assign(root_.array("accessors").size(), false);
    out["meshes"] = meshes();  // before the accessors: only those in use are looked at
    out["accessors"] = accessors();
    out["nodes"] = nodes();
    out["scenes"] = scenes();
    if (root_.has("scene")) out["scene"] = root_.index("scene", out["scenes"].size());
    return out;
  }

 private:
  void check_asset() const {
    const std::string version = root_.object("asset").text("version");
    if (!version.starts_with("2.")) {
      throw rejection{error_code::unsupported, "is glTF version " + in_quotes(version) + ", not 2.0"};
    }
    for (const json& name : root_.array("extensionsRequired")) {
      if (!name.is_string()) reject("extensionsRequired holds something that is not a string");
      const auto text = name.get<std::string>();
      if (!leaves_geometry_alone(text)) {
        throw rejection{error_code::unsupported, "requires the extension " + in_quotes(text) +
                                                     ", which asperity does not read; export it without"};
      }
    }
  }

  json views() {
    json out = json::array();
    for (std::size_t i = 0; i < root_.array("bufferViews").size(); ++i) {
      const json_object view = root_.element("bufferViews", i);
      const std::size_t buffer = view.index("buffer", buffer_bytes_.size());
      const std::uint64_t offset = view.whole("byteOffset", 0);
      const std::uint64_t length = view.whole("byteLength");
      const std::uint64_t stride = view.whole("byteStride", 0);
      // Subtraction, never addition: offset + length can wrap round.
      if (length == 0 || offset > buffer_bytes_[buffer] || length > buffer_bytes_[buffer] - offset) {
        reject(view.path() + " lies outside its buffer of " + std::to_string(buffer_bytes_[buffer]) + " bytes");
      }
      if (stride > 252 || stride % 4 != 0) reject(view.path("byteStride") + " is not a multiple of 4 up to 252");
      json copy{{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
      if (stride != 0) copy["byteStride"] = stride;
      out.push_back(std::move(copy));
      view_bytes_.push_back({length, stride});
    }
    return out;
  }

  json accessors() {
    json out = json::array();
    for (std::size_t i = 0; i < used_.size(); ++i) {
      // One that no mesh uses keeps its place, so that the numbers of the others stay right.
      out.push_back(used_[i] ? accessor(root_.element("accessors", i))
                             : json{{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}});
    }
    return out;
  }

  json accessor(const json_object& a) {
    if (a.has("sparse") || !a.has("bufferView")) {
      throw rejection{error_code::unsupported, a.path() + " is sparse or has no bufferView; export it as plain data"};
    }
    const std::size_t view = a.index("bufferView", view_bytes_.size());
    const std::uint64_t offset = a.whole("byteOffset", 0);
    const std::uint64_t count = a.whole("count");
    const std::uint64_t component = a.whole("componentType");
    const std::string type = a.text("type");
    const std::uint64_t element = component_bytes(component) * component_count(type);
    if (element == 0) reject(a.path() + " has a component type or type that glTF does not know for vertices");
    const auto [length, given_stride] = view_bytes_[view];
    const std::uint64_t stride = given_stride != 0 ? given_stride : element;
    if (count == 0 || stride < element || offset > length || element > length - offset ||
        count - 1 > (length - offset - element) / stride) {
      reject(a.path() + " (count " + std::to_string(count) + ") lies outside its bufferView of " +
             std::to_string(length) + " bytes");
    }
    json copy{
        {"bufferView", view}, {"byteOffset", offset}, {"count", count}, {"componentType", component}, {"type", type}};
    if (a.has("normalized")) copy["normalized"] = a.raw("normalized") == json(true);
    return copy;
  }

  std::size_t use_accessor(const json_object& from, const char* key) {
    const std::size_t i = from.index(key, used_.size());
    used_[i] = true;
    return i;
  }

  json meshes() {
    json out = json::array();
    for (std::size_t m = 0; m < root_.array("meshes").size(); ++m) {
      const json_object mesh = root_.element("meshes", m);
      json primitives = json::array();
      for (std::size_t p = 0; p < mesh.array("primitives").size(); ++p) {
        const json_object primitive = mesh.element("primitives", p);
        const json_object attributes = primitive.object("attributes");
        if (!attributes.has("POSITION")) continue;  // nothing to touch
        json copy{{"mode", primitive.whole("mode", 4)},
                  {"attributes", {{"POSITION", use_accessor(attributes, "POSITION")}}}};
        if (attributes.has("TEXCOORD_0")) copy["attributes"]["TEXCOORD_0"] = use_accessor(attributes, "TEXCOORD_0");
        if (primitive.has("indices")) copy["indices"] = use_accessor(primitive, "indices");
        primitives.push_back(std::move(copy));
      }
      out.push_back({{"primitives", std::move(primitives)}});
    }
    return out;
  }

  /// Array of indices that each name one of `count` nodes.
  static json indices(const json_object& from, const char* key, std::size_t count) {
    const json& list = from.array(key);
    for (const json& i : list) {
      if (!i.is_number_unsigned() || i.get<std::uint64_t>() >= count) {
        reject(from.path(key) + " names something other than one of the " + std::to_string(count) + " nodes");
      }
    }
    return list;
  }

  json nodes() {
    constexpr std::array<std::pair<const char*, std::size_t>, 4> transforms{
        {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}}};
    const std::size_t count = root_.array("nodes").size();
    json out = json::array();
    for (std::size_t n = 0; n < count; ++n) {
      const json_object node = root_.element("nodes", n);
      json copy = json::object();
      if (node.has("mesh")) copy["mesh"] = node.index("mesh", root_.array("meshes").size());
      if (node.has("children")) copy["children"] = indices(node, "children", count);
      for (const auto& [key, size] : transforms) {
        if (!node.has(key)) continue;
        const json& values = node.array(key);
        const bool good = values.size() == size && std::all_of(values.begin(), values.end(), [](const json& x) {
                            return x.is_number() && std::isfinite(x.get<double>());
                          });
        if (!good) reject(node.path(key) + " does not hold " + std::to_string(size) + " finite numbers");
        copy[key] = values;
      }
      out.push_back(std::move(copy));
    }
    return out;
  }

  json scenes() {
    json out = json::array();
    for (std::size_t s = 0; s < root_.array("scenes").size(); ++s) {
      out.push_back({{"nodes", indices(root_.element("scenes", s), "nodes", root_.array("nodes").size())}});
    }
    return out;
  }

  struct view_size {
    std::uint64_t length, stride;
  };

  json_object root_;
  const std::vector<std::size_t>& buffer_bytes_;
  std::vector<view_size> view_bytes_;
  std::vector<bool> used_;  // accessors that some primitive names
};

/// Bytes of JSON between two questions whether to go on.
constexpr std::size_t watch_every = std::size_t{1} << 18;

/// Characters for a parser that asks on its way whether to go on.
class watched_iterator {
 public:
  using iterator_category = std::forward_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  watched_iterator() = default;
  watched_iterator(const char* at, const reading_watch& watch) noexcept : first_(at), at_(at), watch_(&watch) {}
  reference operator*() const noexcept { return *at_; }
  watched_iterator& operator++() {
    if (static_cast<std::size_t>(++at_ - first_) % watch_every == 0) watch_->ask();
    return *this;
  }
  watched_iterator operator++(int) {
    watched_iterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const watched_iterator& other) const noexcept { return at_ == other.at_; }

 private:
  const char* first_ = nullptr;  // counts from here, so that as many questions are asked wherever the text lies
  const char* at_ = nullptr;
  const reading_watch* watch_ = nullptr;
};

/// Counts levels and items without a parser. Throws rejection.
void check_extent(std::string_view text, const json_limits& limits, const reading_watch& watch) {
  int depth = 0;
  std::size_t items = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (i % watch_every == 0) watch.ask();
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (c == '[' || c == '{' || c == ',') ++items;
    if (depth > limits.depth) {
      throw rejection{error_code::limit_exceeded, "nests its JSON deeper than " + std::to_string(limits.depth) +
                                                      " levels at byte " + std::to_string(i) + " of it"};
    }
    if (items > limits.items) {
      throw rejection{error_code::limit_exceeded, "holds more than " + std::to_string(limits.items) +
                                                      " JSON items, the last at byte " + std::to_string(i) + " of it"};
    }
  }
}

/// Reads JSON once without keeping it: finds where it is wrong, and an object that has a name twice. Throws rejection.
/// A pass of its own, because the parser that also builds the document asks its callback in quadratic time.
class json_inspector final : public nlohmann::json_sax<json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }

  bool start_object(std::size_t) override {
    names_.emplace_back();
    return true;
  }
  bool end_object() override {
    names_.pop_back();
    return true;
  }
  bool key(string_t& name) override {
    if (!names_.back().insert(name).second) {
      reject("holds JSON with the name " + in_quotes(name) + " twice in one object");
    }
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const json::exception& e) override {
    if (dynamic_cast<const json::out_of_range*>(&e) != nullptr) {
      reject("holds JSON that does not parse: a number in it is too large");
    }
    reject("holds JSON that does not parse: byte " + std::to_string(position) + " of it is wrong");
  }

 private:
  std::vector<std::set<std::string>> names_;  // of the objects that are open
};

}  // namespace

glb_chunks split_glb(std::string_view bytes) {
  if (bytes.size() < header_bytes + chunk_header_bytes) {
    reject("has " + std::to_string(bytes.size()) + " bytes, fewer than the header of a .glb: the file is cut off");
  }
  if (word_at(bytes, 0) != magic_gltf) reject("does not begin with 'glTF' (byte 0), so it is no .glb");
  if (word_at(bytes, 4) != 2) {
    throw rejection{error_code::unsupported, "is a .glb of version " + std::to_string(word_at(bytes, 4)) + ", not 2"};
  }
  if (word_at(bytes, 8) != bytes.size()) {
    reject("byte 8 announces " + std::to_string(word_at(bytes, 8)) + " bytes, but the file has " +
           std::to_string(bytes.size()) + ": it is cut off or has been changed");
  }
  const auto chunk_at = [&](std::size_t offset, std::uint32_t type, const char* name) {
    const std::size_t left = bytes.size() - offset;
    if (left < chunk_header_bytes) reject("byte " + std::to_string(offset) + " begins no whole chunk header");
    const std::size_t length = word_at(bytes, offset);
    if (word_at(bytes, offset + 4) != type || length % 4 != 0 || length > left - chunk_header_bytes) {
      reject("byte " + std::to_string(offset) + " begins no " + name + " chunk that fits the file");
    }
    return bytes.substr(offset + chunk_header_bytes, length);
  };
  glb_chunks chunks;
  chunks.json = chunk_at(header_bytes, chunk_json, "JSON");
  const std::size_t next = header_bytes + chunk_header_bytes + chunks.json.size();
  if (next != bytes.size()) {
    chunks.bin = chunk_at(next, chunk_bin, "BIN");
    const std::size_t end = next + chunk_header_bytes + chunks.bin.size();
    if (end != bytes.size()) reject("byte " + std::to_string(end) + " is past the BIN chunk, where nothing belongs");
  }
  return chunks;
}

json parse_bounded(std::string_view text, const json_limits& limits, reading_watch& watch) {
  if (text.size() > limits.bytes) {
    throw rejection{error_code::limit_exceeded, "holds " + std::to_string(text.size()) +
                                                    " bytes of JSON, more than the limit of " +
                                                    std::to_string(limits.bytes)};
  }
  check_extent(text, limits, watch);
  const watched_iterator begin(text.data(), watch);
  const watched_iterator end(text.data() + text.size(), watch);
  json_inspector inspector;
  json::sax_parse(begin, end, &inspector);
  json document = json::parse(begin, end, nullptr, false);
  if (!document.is_object()) reject("holds JSON that does not parse as an object");
  return document;
}

json checked_geometry(const json& document, const std::vector<std::size_t>& buffer_bytes) {
  return geometry_checker(document, buffer_bytes).check();
}

}  // namespace asperity::io
