#include "asperity/plugin/plugin_driver.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include "asperity/device/driver_conversion.hpp"
#include "guarded_call.hpp"
#include "listing_conversion.hpp"

namespace asperity::plugin {
namespace {

constexpr std::size_t most_devices = 64;

// What list() gathers. Nothing is thrown back into the driver.
struct gathering {
  std::string_view driver;
  std::vector<device_listing> found{};
  std::vector<std::unique_ptr<asperity_capabilities>> capabilities{};
  std::string problem{};

  static std::int32_t add(void* context, const asperity_listing* listing) noexcept {
    auto& self = *static_cast<gathering*>(context);
    const std::int32_t code = guarded_call([&] { return self.take(listing); });
    if (code == call_threw) self.problem = "a device could not be taken down: out of memory";
    return code;
  }

  std::int32_t take(const asperity_listing* listing) {
    if (listing == nullptr || listing->struct_size < offsetof(asperity_listing, capabilities)) {
      problem = "a listing is shorter than its texts";
      return 1;
    }
    if (found.size() == most_devices) {
      problem = "it lists more than 64 devices";
      return 1;
    }
    const asperity_listing l = abi::copy_in(*listing);
    if (const std::optional<std::string> wrong = find_problem(l)) {
      problem = *wrong;
      return 1;
    }
    device_listing d = from_listing(driver, l);
    if (l.capabilities != nullptr) {
      auto c = std::make_unique<asperity_capabilities>(abi::copy_in(*l.capabilities));
      if (const std::optional<std::string> wrong = find_problem(*c)) {
        problem = "the capabilities of " + d.identity + ": " + *wrong;
        return 1;
      }
      d.capabilities = abi::from_abi(*c);
      capabilities.push_back(std::move(c));
    }
    found.push_back(std::move(d));
    return 0;
  }
};

}  // namespace

result<std::unique_ptr<plugin_driver>> plugin_driver::load(const std::filesystem::path& file, log_sink log,
                                                           file_trust trust) {
  result<std::shared_ptr<const driver_module>> m = driver_module::load(file, std::move(log), trust);
  if (!m) return m.error();
  return std::make_unique<plugin_driver>(std::move(m).value());
}

result<std::vector<device_listing>> plugin_driver::list() {
  gathering g{.driver = name()};
  char text[ASPERITY_TEXT_SIZE] = "";
  const std::int32_t code = guarded_call([&] { return module_->table().list(&g, gathering::add, text, sizeof text); });
  if (!g.problem.empty()) {
    return error{error_code::bad_format, module_->where() + ": what the driver lists cannot be: " + g.problem};
  }
  if (code != ASPERITY_OK) return error{error_code::io_failed, module_->where() + ": " + driver_error(code, text)};
  listed_ = std::move(g.capabilities);
  return std::move(g.found);
}

result<plugin_device> plugin_driver::make_plugin(const device_listing& which) {
  const result<asperity_listing> l = to_listing(which);
  if (!l) return l.error();
  asperity_device* made = nullptr;
  char text[ASPERITY_TEXT_SIZE] = "";
  const std::int32_t code = guarded_call([&] { return module_->table().make(&*l, &made, text, sizeof text); });
  if (code != ASPERITY_OK) return error{error_code::io_failed, module_->where() + ": " + driver_error(code, text)};
  if (made == nullptr) {
    return error{error_code::bad_format, module_->where() + ": make() says that it made a device, and gives none"};
  }
  return plugin_device::adopt(module_, made);
}

result<any_device> plugin_driver::make(const device_listing& which) {
  result<plugin_device> d = make_plugin(which);
  if (!d) return d.error();
  return any_device(std::move(d).value());
}

}  // namespace asperity::plugin
