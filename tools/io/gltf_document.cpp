#include "gltf_document.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "file_bytes.hpp"
#include "text_cursor.hpp"

namespace asperity::io {
namespace {

namespace fs = std::filesystem;

/// JSON of a .gltf may be larger than that of a .glb: buffers can stand in it as text.
constexpr std::size_t max_text_bytes = std::size_t{128} << 20;
/// Each buffer is a file that is opened, or a text that is decoded.
constexpr std::size_t max_buffers = 64;

std::string accessor_name(int accessor) { return "accessors[" + std::to_string(accessor) + "]"; }

/// A URI's %20 and the like as characters. Throws rejection.
std::string percent_decoded(const std::string& uri, const std::string& place) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      out += uri[i];
      continue;
    }
    unsigned code = 0;
    const char* first = uri.data() + i + 1;
    if (i + 2 >= uri.size() || std::from_chars(first, first + 2, code, 16).ptr != first + 2) {
      reject(place + " has a broken % code");
    }
    out += static_cast<char>(code);
    i += 2;
  }
  return out;
}

/// The file that a relative URI names, by its path from the document's folder, where it lies in that folder or below.
/// Names alone decide here; links are the opener's to refuse. Throws rejection.
fs::path below(const std::string& uri, const std::string& place) {
  const std::string name = percent_decoded(uri, place);
  if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 0x7f || c == '\\'; })) {
    reject(place + " holds a backslash or a control character; give the buffer a plain name");
  }
  const fs::path path = fs::path(name).lexically_normal();
  const bool has_scheme = uri.find(':') != std::string::npos;
  if (has_scheme || path.is_absolute() || path.filename().empty() || *path.begin() == ".." || *path.begin() == ".") {
    reject(place + " leads out of the document's folder; put the buffer beside it");
  }
  return path;
}

/// The bytes of a data URI, which is base64 here. Throws rejection.
std::string data_uri_bytes(std::string_view uri, const std::string& place, reading_watch& watch) {
  static constexpr std::string_view mark = ";base64,";
  static const std::array<std::uint8_t, 256> values = [] {
    std::array<std::uint8_t, 256> out{};
    out.fill(64);
    std::uint8_t next = 0;
    for (const char c : std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")) {
      out[static_cast<unsigned char>(c)] = next++;
    }
    return out;
  }();
  static constexpr std::array<std::string_view, 5> kinds{"data:application/octet-stream",
                                                         "data:application/gltf-buffer", "data:image/png",
                                                         "data:image/jpeg", "data:text/plain"};
  const std::size_t begin = uri.substr(0, 64).find(mark);
  bool good = begin != std::string_view::npos && std::ranges::find(kinds, uri.substr(0, begin)) != kinds.end();
  std::string_view text = good ? uri.substr(begin + mark.size()) : std::string_view();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  good = good && text.size() % 4 != 1;
  std::string out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size() && good; ++i) {
    watch.step();
    const std::uint8_t value = values[static_cast<unsigned char>(text[i])];
    good = value < 64;
    bits = bits << 6U | value;
    // Of each four characters the first brings no whole byte.
    if (i % 4 != 0) out += static_cast<char>(bits >> (6U - 2U * (i % 4)) & 0xffU);
  }
  if (!good) reject(place + " is no base64 data URI of a buffer or an image");
  return out;
}

/// Refuses every file: the guard has read what may be read.
tinygltf::FsCallbacks no_files() {
  return {[](const std::string&, void*) { return false; }, [](const std::string& name, void*) { return name; },
          [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
          [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, nullptr};
}

}  // namespace

gltf_document::gltf_document(std::string_view bytes, const fs::path& file, buffer_policy policy, reading_watch& watch)
    : watch_(watch) {
  glb_chunks chunks;
  json_limits limits;
  if (policy == buffer_policy::own_folder && !bytes.starts_with("glTF")) {
    chunks.json = bytes;
    limits.bytes = max_text_bytes;
  } else {
    chunks = split_glb(bytes);
  }
  source_ = parse_bounded(chunks.json, limits, watch);
  collect_buffers(chunks.bin, file, policy);
  std::vector<std::size_t> sizes;
  for (const std::string_view b : buffers_) sizes.push_back(b.size());
  const std::string checked = checked_geometry(source_, sizes).dump();

  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks(no_files());
  parser.RemoveImageLoader();
  std::string problem;
  std::string warning;
  if (!parser.LoadASCIIFromString(&geometry_, &problem, &warning, checked.data(), static_cast<unsigned>(checked.size()),
                                  "")) {
    reject("is not accepted by the glTF parser: " + problem.substr(0, problem.find('\n')));
  }
}

void gltf_document::collect_buffers(std::string_view bin, const fs::path& file, buffer_policy policy) {
  const json_object root(source_, "the document");
  const std::size_t count = root.array("buffers").size();
  if (count > max_buffers) {
    throw rejection{error_code::limit_exceeded,
                    "has " + std::to_string(count) + " buffers, more than the limit of " + std::to_string(max_buffers)};
  }
  owned_.reserve(count);  // views into these strings must not move
  for (std::size_t i = 0; i < count; ++i) {
    const json_object buffer = root.element("buffers", i);
    const std::uint64_t length = buffer.whole("byteLength");
    std::string_view bytes = bin;
    if (buffer.has("uri")) {
      if (policy == buffer_policy::own_chunk_only) {
        reject(buffer.path("uri") + " names data outside the file, which a textured model never does");
      }
      bytes = owned_.emplace_back(outside_buffer(buffer.text("uri"), buffer.path("uri"), file));
    } else if (i != 0) {
      reject(buffer.path() + " has no uri, and only the first buffer may be the BIN chunk");
    }
    if (length == 0 || length > bytes.size()) {
      reject(buffer.path("byteLength") + " is " + std::to_string(length) + ", but there are " +
             std::to_string(bytes.size()) + " bytes");
    }
    buffers_.push_back(bytes.substr(0, static_cast<std::size_t>(length)));
  }
}

std::string gltf_document::outside_buffer(const std::string& uri, const std::string& place, const fs::path& file) {
  if (!uri.starts_with("data:") && !opened_.insert(below(uri, place)).second) {
    reject(place + " names a file that another buffer has named; give each buffer a file of its own");
  }
  std::uintmax_t total = 0;
  for (const std::string& other : owned_) total += other.size();
  return outside_bytes(uri, place, file, max_mesh_bytes - total, watch_);
}

std::string gltf_document::outside_bytes(const std::string& uri, const std::string& place, const fs::path& file,
                                         std::uintmax_t limit, reading_watch& watch) {
  if (uri.starts_with("data:")) return data_uri_bytes(uri, place, watch);
  auto bytes = read_file_below(fs::absolute(file).parent_path(), below(uri, place), limit, watch);
  if (!bytes) throw rejection{bytes.error().code, place + " names " + bytes.error().message};
  return std::move(bytes).value();
}

std::string_view gltf_document::view_bytes(std::size_t view) const {
  const tinygltf::BufferView& v = geometry_.bufferViews[view];
  return buffers_[static_cast<std::size_t>(v.buffer)].substr(v.byteOffset, v.byteLength);
}

const char* gltf_document::element(const tinygltf::Accessor& a, std::size_t i) const {
  const tinygltf::BufferView& v = geometry_.bufferViews[static_cast<std::size_t>(a.bufferView)];
  const auto stride = static_cast<std::size_t>(a.ByteStride(v));
  return buffers_[static_cast<std::size_t>(v.buffer)].data() + v.byteOffset + a.byteOffset + i * stride;
}

std::vector<vec3> gltf_document::positions(int accessor) const {
  const tinygltf::Accessor& a = geometry_.accessors[static_cast<std::size_t>(accessor)];
  if (a.type != TINYGLTF_TYPE_VEC3 || a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
    throw rejection{error_code::unsupported, accessor_name(accessor) + " holds positions that are not float32 VEC3"};
  }
  std::vector<vec3> out;
  out.reserve(a.count);
  for (std::size_t i = 0; i < a.count; ++i) {
    watch_.step();
    out.emplace_back(load_number<glm::vec3>(element(a, i)));
    if (!is_finite(out.back())) {
      reject(accessor_name(accessor) + " has a coordinate that is not finite at vertex " + std::to_string(i));
    }
  }
  return out;
}

std::vector<vec2> gltf_document::uvs(int accessor) const {
  const tinygltf::Accessor& a = geometry_.accessors[static_cast<std::size_t>(accessor)];
  const bool single = a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
  const bool bytes = a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
  if (a.type != TINYGLTF_TYPE_VEC2 ||
      !(single || ((bytes || a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) && a.normalized))) {
    throw rejection{error_code::unsupported,
                    accessor_name(accessor) + " holds texture coordinates that are neither float32 nor normalised"};
  }
  std::vector<vec2> out;
  out.reserve(a.count);
  for (std::size_t i = 0; i < a.count; ++i) {
    watch_.step();
    const char* at = element(a, i);
    const vec2 uv = single  ? vec2(load_number<glm::vec2>(at))
                    : bytes ? vec2(load_number<std::uint8_t>(at), load_number<std::uint8_t>(at + 1)) / 255.0
                            : vec2(load_number<std::uint16_t>(at), load_number<std::uint16_t>(at + 2)) / 65535.0;
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      reject(accessor_name(accessor) + " has a texture coordinate that is not finite at vertex " + std::to_string(i));
    }
    out.push_back(uv);
  }
  return out;
}

std::vector<std::uint32_t> gltf_document::indices(int accessor, std::size_t vertex_count) const {
  std::vector<std::uint32_t> out;
  if (accessor < 0) {
    out.resize(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i) out[i] = static_cast<std::uint32_t>(i);
    return out;
  }
  const tinygltf::Accessor& a = geometry_.accessors[static_cast<std::size_t>(accessor)];
  const bool known = a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                     a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                     a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (a.type != TINYGLTF_TYPE_SCALAR || !known) reject(accessor_name(accessor) + " holds indices of a wrong type");
  out.reserve(a.count);
  for (std::size_t i = 0; i < a.count; ++i) {
    watch_.step();
    const char* at = element(a, i);
    const std::uint32_t v = a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ? load_number<std::uint8_t>(at)
                            : a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
                                ? load_number<std::uint16_t>(at)
                                : load_number<std::uint32_t>(at);
    if (v >= vertex_count) {
      reject(accessor_name(accessor) + " entry " + std::to_string(i) + " names vertex " + std::to_string(v) + " of " +
             std::to_string(vertex_count));
    }
    out.push_back(v);
  }
  return out;
}

}  // namespace asperity::io
