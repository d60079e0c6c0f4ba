// Typed access to JSON that nobody has checked yet. A missing or wrong field is thrown as a rejection, caught where the
// reader begins: the checks then read as a list instead of a ladder.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "asperity/core/math.hpp"
#include "asperity/core/status.hpp"
#include "reading_watch.hpp"

namespace asperity::io {

using json = nlohmann::json;

/// A JSON object and its place in the document, for messages.
class json_object {
 public:
  json_object(const json& value, std::string path) : value_(value), path_(std::move(path)) {
    if (!value.is_object()) reject(path_ + " is not a JSON object");
  }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string path(const char* key) const { return path_ + "." + key; }
  [[nodiscard]] bool has(const char* key) const { return value_.contains(key); }
  [[nodiscard]] const json& raw(const char* key) const {
    const auto it = value_.find(key);
    if (it == value_.end()) reject(path(key) + " is missing");
    return *it;
  }

  [[nodiscard]] std::uint64_t whole(const char* key) const {
    const json& v = raw(key);
    if (!v.is_number_unsigned()) reject(path(key) + " is not a whole number from 0");
    return v.get<std::uint64_t>();
  }
  [[nodiscard]] std::uint64_t whole(const char* key, std::uint64_t fallback) const {
    return has(key) ? whole(key) : fallback;
  }
  /// A whole number that names one of `count` things.
  [[nodiscard]] std::size_t index(const char* key, std::size_t count) const {
    const std::uint64_t i = whole(key);
    if (i >= count) reject(path(key) + " is " + std::to_string(i) + ", but there are only " + std::to_string(count));
    return static_cast<std::size_t>(i);
  }
  [[nodiscard]] double number(const char* key) const {
    const json& v = raw(key);
    if (!v.is_number() || !std::isfinite(v.get<double>())) reject(path(key) + " is not a finite number");
    return v.get<double>();
  }
  /// Three finite numbers.
  [[nodiscard]] vec3 vector(const char* key) const {
    const json& v = raw(key);
    vec3 out{0.0};
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (!v.is_array() || v.size() != 3 || !v[at].is_number() || !std::isfinite(v[at].get<double>())) {
        reject(path(key) + " is not three finite numbers");
      }
      out[i] = v[at].get<double>();
    }
    return out;
  }
  [[nodiscard]] std::string text(const char* key) const {
    const json& v = raw(key);
    if (!v.is_string()) reject(path(key) + " is not a string");
    return v.get<std::string>();
  }
  [[nodiscard]] json_object object(const char* key) const { return {raw(key), path(key)}; }
  /// The array under a key; an empty one where the key is absent.
  [[nodiscard]] const json& array(const char* key) const {
    static const json empty = json::array();
    if (!has(key)) return empty;
    const json& v = raw(key);
    if (!v.is_array()) reject(path(key) + " is not an array");
    return v;
  }
  /// Element i of the array under a key, as an object.
  [[nodiscard]] json_object element(const char* key, std::size_t i) const {
    return {array(key)[i], path(key) + "[" + std::to_string(i) + "]"};
  }

 private:
  const json& value_;
  std::string path_;
};

}  // namespace asperity::io
