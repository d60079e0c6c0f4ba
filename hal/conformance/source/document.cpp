#include "document.hpp"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "asperity/version.hpp"

namespace asperity::conformance {
namespace {

using json = nlohmann::ordered_json;

struct totals {
  int passed = 0;
  int failed = 0;
  int not_applicable = 0;
};

totals count(const report& r) {
  totals t;
  for (const check_result& c : r.found.checks()) {
    (c.result == outcome::passed ? t.passed : (c.result == outcome::failed ? t.failed : t.not_applicable))++;
  }
  return t;
}

std::string short_number(double v) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", v);
  return text.data();
}

const char* key_of(outcome o) noexcept {
  return o == outcome::passed ? "pass" : (o == outcome::failed ? "fail" : "not_applicable");
}

std::string line(const char* what, const std::string& value) {
  std::string out = std::string(what) + value + "\n";
  return value.empty() ? std::string() : out;
}

}  // namespace

std::string to_text(const report& r) {
  const totals t = count(r);
  std::string out = "asperity conformance report, kit " ASPERITY_VERSION_STRING "\n";
  out += line("date      ", r.date);
  out += line("file      ", r.file);
  if (!r.driver.empty()) {
    out += "driver    " + r.driver + " " + r.version + " (" + r.vendor + ", " + r.licence + ", " + r.driver_maturity +
           "), interface " + r.abi + "\n";
  }
  if (!r.device.empty()) {
    out += "device    " + r.device + ", " + r.device_name + " (" + r.device_maturity + ") at " + r.path + "\n";
    out += std::string("clock     ") + (r.virtual_clock ? "virtual: the device is simulated" : "real") +
           (r.hand_held ? "; held in a hand\n" : "\n");
  }
  out += "\n";
  for (const check_result& c : r.found.checks()) {
    std::array<char, 80> head{};
    std::snprintf(head.data(), head.size(), "%-15s %-34s ", to_string(c.result), c.name.c_str());
    out += head.data() + (c.reason.empty() ? c.asks : c.reason) + "\n";
  }
  if (!r.found.figures().empty()) {
    out += "\n";
    for (const figure& f : r.found.figures()) {
      std::array<char, 80> head{};
      std::snprintf(head.data(), head.size(), "%-50s ", f.name.c_str());
      out += head.data() + short_number(f.value) + " " + f.unit + "\n";
    }
  }
  out += "\n" + std::to_string(t.passed) + " passed, " + std::to_string(t.failed) + " failed, " +
         std::to_string(t.not_applicable) + " not applicable\n";
  return out;
}

std::string to_json(const report& r) {
  const totals t = count(r);
  json d;
  d["schema"] = "asperity.conformance/1";
  d["kit"] = ASPERITY_VERSION_STRING;
  d["date"] = r.date;
  d["file"] = r.file;
  d["driver"] = {{"name", r.driver},     {"version", r.version},          {"vendor", r.vendor},
                 {"licence", r.licence}, {"maturity", r.driver_maturity}, {"interface", r.abi}};
  d["device"] = {{"identity", r.device}, {"name", r.device_name}, {"path", r.path}, {"maturity", r.device_maturity}};
  d["clock"] = r.virtual_clock ? "virtual" : "real";
  d["hand_held"] = r.hand_held;
  d["checks"] = json::array();
  for (const check_result& c : r.found.checks()) {
    json one = {{"name", c.name}, {"asks", c.asks}, {"result", key_of(c.result)}, {"looks", c.looks}};
    if (!c.reason.empty()) one["reason"] = c.reason;
    d["checks"].push_back(one);
  }
  d["figures"] = json::array();
  for (const figure& f : r.found.figures()) {
    d["figures"].push_back({{"name", f.name}, {"value", f.value}, {"unit", f.unit}});
  }
  d["passed"] = t.passed;
  d["failed"] = t.failed;
  d["not_applicable"] = t.not_applicable;
  d["conforms"] = t.failed == 0;
  // What a driver says is not always UTF-8.
  return d.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace asperity::conformance
