#include "gltf_mutator.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "unit/io/glb_editor.hpp"

namespace asperity::hostile {
namespace {

using nlohmann::json;
using test_support::glb_editor;

/// Every place in a document, leaves and inner ones.
void collect(json& at, std::vector<json*>& places) {
  for (json& item : at) {
    places.push_back(&item);
    if (item.is_structured()) collect(item, places);
  }
}

json strange_value(random_source& random) {
  static const std::vector<json> values{0,
                                        1,
                                        -1,
                                        3,
                                        255,
                                        4096,
                                        65536,
                                        2147483647,
                                        4294967295U,
                                        1099511627776U,
                                        18446744073709551608U,
                                        0.5,
                                        -0.0,
                                        1e300,
                                        nullptr,
                                        true,
                                        "x",
                                        "VEC3",
                                        "../secret.bin",
                                        json::array(),
                                        json::object()};
  return random.one_of(values);
}

/// A number near the one that stands there, or a strange one.
void change_number(json& at, random_source& random) {
  if (random.once_in(3)) {
    at = strange_value(random);
  } else if (at.is_number_unsigned()) {
    const auto value = at.get<std::uint64_t>();
    const std::array<std::uint64_t, 6> near{value + 1, value - (value > 0 ? 1 : 0),
                                            value / 2, 2 * value,
                                            value + 4, value ^ (std::uint64_t{1} << random.below(40))};
    at = random.one_of(near);
  } else {
    at = at.get<double>() * (random.once_in(2) ? -1.0 : 1.5);
  }
}

void rename(json& object, random_source& random) {
  if (!object.is_object() || object.empty()) return;
  auto at = std::next(object.begin(), static_cast<std::ptrdiff_t>(random.below(object.size())));
  const json value = *at;
  const std::string name = at.key();
  object.erase(at);
  if (random.once_in(3)) return;  // dropped
  object[random.once_in(2) ? name + "x" : std::string("extras")] = value;
}

void change_document(json& document, random_source& random) {
  std::vector<json*> places;
  collect(document, places);
  if (places.empty()) return;
  json& at = *random.one_of(places);
  switch (random.below(8)) {
    case 0: {  // a place takes what another one holds
      const json copy = *random.one_of(places);
      at = copy;
      break;
    }
    case 1:
      rename(at, random);
      break;
    case 2:
      if (!at.is_array() || at.empty()) break;
      if (random.once_in(2)) {
        std::swap(at[random.below(at.size())], at[random.below(at.size())]);
      } else {
        const json copy = at[random.below(at.size())];
        at.push_back(copy);
      }
      break;
    case 3:
      if (at.is_array() && !at.empty()) at.erase(random.below(at.size()));
      break;
    case 4:
      for (std::size_t depth = random.below(40); depth > 0; --depth) at = json::array({at});
      break;
    default:
      if (at.is_number()) {
        change_number(at, random);
      } else if (!at.is_structured()) {
        at = strange_value(random);
      }
  }
}

/// Bytes that mean something in an array of numbers.
void change_bin(std::string& bin, random_source& random) {
  static const std::vector<std::uint32_t> words{0,          1,          3,          7,          24,
                                                0x7fc00000, 0x7f800000, 0xff800000, 0x3f800000, 0xbf800000,
                                                0x0d000000, 0x7149f2ca, 0xffffffff, 0x7fffffff};
  if (bin.size() < 8) return;
  if (random.once_in(12)) {
    bin.resize(4 * (1 + random.below(bin.size() / 4)));
    return;
  }
  const std::size_t at = 4 * random.below(bin.size() / 4 - 1);
  std::uint32_t word = 0;
  std::memcpy(&word, bin.data() + at, 4);
  switch (random.below(4)) {
    case 0:
      word = random.one_of(words);
      break;
    case 1:
      word ^= 1U << random.below(32);
      break;
    case 2:
      word += random.once_in(2) ? 1U : 0xffffffffU;
      break;
    default:
      word = static_cast<std::uint32_t>(random.bits());
  }
  std::memcpy(bin.data() + at, &word, 4);
}

}  // namespace

std::string mutated_glb(const std::string& glb, random_source& random) {
  glb_editor editor(glb);
  for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
    if (random.once_in(2)) {
      change_document(editor.json, random);
    } else {
      change_bin(editor.bin, random);
    }
  }
  // Names and strings stay UTF-8: dump() would refuse others, and the attacks have those.
  std::string out = editor.bytes();
  if (random.once_in(40)) {  // the envelope and the text itself
    out[random.below(out.size())] = static_cast<char>(random.bits());
  } else if (random.once_in(40)) {
    out.resize(random.below(out.size()) + 1);
  }
  return out;
}

}  // namespace asperity::hostile
