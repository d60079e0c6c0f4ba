#include "kit.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "asperity/device/capabilities.hpp"
#include "asperity/device/driver_conversion.hpp"
#include "asperity/plugin/driver_module.hpp"
#include "checks.hpp"
#include "subject.hpp"

namespace asperity::conformance {
namespace {

// The checks of the table come one after the other: what failed is told, what came before it passed.
void look_at_loading(ledger& found, const plugin::load_failure* failure) {
  using plugin::table_fault;
  static constexpr std::pair<const char*, table_fault> steps[] = {
      {"table.loads", table_fault::not_loadable},  {"table.entry", table_fault::no_entry},
      {"table.version", table_fault::abi_major},   {"table.size", table_fault::struct_size},
      {"table.mandatory", table_fault::mandatory}, {"table.texts", table_fault::text}};
  for (const auto& [check, fault] : steps) {
    const bool refused = fault == table_fault::no_entry && failure != nullptr && failure->fault == table_fault::refused;
    if (!found.look(check, failure == nullptr || (failure->fault != fault && !refused),
                    [&] { return failure->why.message; })) {
      return;
    }
  }
}

struct listed_device {
  asperity_listing listing;
  asperity_capabilities capabilities;
};

struct gathering {
  std::vector<listed_device> devices{};
  std::optional<std::string> problem{};
  bool short_listing = false;

  static std::int32_t add(void* context, const asperity_listing* l) noexcept {
    auto& self = *static_cast<gathering*>(context);
    if (l == nullptr || l->struct_size < offsetof(asperity_listing, capabilities) || self.devices.size() == 64) {
      self.short_listing = true;
      return 1;
    }
    listed_device d{abi::copy_in(*l), abi::blank<asperity_capabilities>()};
    if (d.listing.capabilities != nullptr) d.capabilities = abi::copy_in(*d.listing.capabilities);
    d.listing.capabilities = nullptr;
    d.listing.struct_size = sizeof(asperity_listing);
    if (!self.problem) self.problem = plugin::find_problem(d.listing);
    self.devices.push_back(d);
    return 0;
  }
};

std::string text_of(std::span<const char> field) { return std::string(abi::get_text(field).value_or("")); }

std::optional<asperity_listing> find_device(const asperity_driver& t, const kit_options& options, report& r,
                                            progress& shared) {
  r.found.begin("list()");
  shared.enter("list", "list()");
  gathering g;
  char error[ASPERITY_TEXT_SIZE] = "";
  std::int32_t code = ASPERITY_FAILED;
  bool thrown = true;
  try {
    code = t.list(&g, gathering::add, error, sizeof error);
    thrown = false;
  } catch (...) {
  }
  error[sizeof error - 1] = '\0';
  r.found.look("border.nothing_thrown", !thrown, [] { return "list() threw an exception"; });
  r.found.look("list.answers", code == ASPERITY_OK, [&] { return "list() failed: " + std::string(error); });
  r.found.look("list.texts", !g.problem && !g.short_listing, [&] {
    return g.problem ? *g.problem : std::string("a listing is too short, or there are more than 64");
  });
  const auto wanted = std::find_if(g.devices.begin(), g.devices.end(), [&](const listed_device& d) {
    return !options.device || text_of(d.listing.identity) == *options.device;
  });
  r.found.look("list.answers", code != ASPERITY_OK || wanted != g.devices.end(), [&] {
    return options.device ? "the device " + *options.device + " is not listed" : "no device is plugged in";
  });
  if (wanted == g.devices.end() || r.found.failed()) return std::nullopt;
  const std::string why_not = text_of(wanted->listing.not_openable);
  r.found.look("list.answers", why_not.empty(), [&] { return "the device cannot be opened: " + why_not; });
  return wanted->listing;
}

}  // namespace

report examine(const kit_options& options, progress& shared) {
  report r{.file = options.driver.string(), .date = options.date, .hand_held = options.hand_held};
  r.found.begin("loading");
  shared.enter("asperity_driver_entry", "loading");
  plugin::load_failure failure{};
  const std::shared_ptr<const plugin::driver_module> module =
      plugin::driver_module::load(options.driver, {}, failure, plugin::file_trust::as_named);
  look_at_loading(r.found, module == nullptr ? &failure : nullptr);
  if (module == nullptr) {
    r.found.skip_rest("the driver was not loaded");
    return r;
  }
  const asperity_driver& t = module->table();
  r.driver = t.name;
  r.version = t.version;
  r.licence = t.licence;
  r.vendor = t.vendor;
  r.driver_maturity = to_string(static_cast<driver_maturity>(t.maturity));
  r.abi = std::to_string(t.abi_major) + "." + std::to_string(t.abi_minor);

  const std::optional<asperity_listing> which = find_device(t, options, r, shared);
  if (!which || r.found.failed()) {
    r.found.skip_rest("there is no device to try");
    return r;
  }
  r.device = text_of(which->identity);
  r.path = text_of(which->path);
  r.device_name = text_of(which->name);
  r.device_maturity = to_string(static_cast<driver_maturity>(which->maturity));
  r.virtual_clock = which->maturity == ASPERITY_MATURITY_SIMULATED;

  kit_clock clock(!r.virtual_clock);
  {
    subject device(t, *which, clock, r.found, shared);
    device.may_push = r.virtual_clock || options.hand_held;
    check_statements(device, r.found);
    if (device.state() == device_state::ready) {
      check_states(device, r.found);
      check_session(device, r.found, {.ticks = options.ticks});
      check_commands(device, r.found);
      check_faults(device, r.found);
    }
    r.found.begin("the end");
    r.found.measured("times_opened", device.times_opened(), "");
  }
  r.found.look("process.survives", true, [] { return ""; });

  if (const std::string why = call_watch::missing(); !why.empty()) {
    for (const char* check :
         {"rt.no_allocation", "rt.no_lock", "rt.no_wait", "rt.no_clock", "rt.no_print", "rt.no_throw"}) {
      r.found.skip(check, why);
    }
  }
  if (t.applied == nullptr) {
    for (const char* check :
         {"output.within_limits", "output.zero_unless_armed", "output.zero_after_disarm", "output.zero_after_close"}) {
      r.found.skip(check, "the driver has no applied(), so that nobody sees what it puts out");
    }
  }
  r.found.skip("units.positions", "the device senses no translation");
  r.found.skip_rest("it did not come to this");
  return r;
}

}  // namespace asperity::conformance
