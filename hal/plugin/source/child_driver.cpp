#include "asperity/plugin/child_driver.hpp"

#include <memory>
#include <span>
#include <utility>

#include "child_link.hpp"
#include "listing_conversion.hpp"

namespace asperity::plugin {
namespace {

// The functions of the C interface for a handle that is a link. plugin_device stands before them as it does before a
// driver in this process, so that there is one place that disbelieves drivers.
struct linked_calls {
  static child_link& of(asperity_device* d) noexcept { return *reinterpret_cast<child_link*>(d); }
  static child_link& of(const asperity_device* d) noexcept {
    // The handle is ours, and the exchange changes whenever it is asked: constness is the caller's view of the device.
    return *reinterpret_cast<child_link*>(const_cast<asperity_device*>(d));  // NOLINT(*-const-cast)
  }

  template <std::size_t N>
  static void put(char* text, std::uint32_t text_size, const char (&from)[N]) {
    if (text != nullptr) abi::put_text({text, text_size}, from);
  }

  static std::int32_t set_up(child_call what, asperity_device* d, char* text, std::uint32_t text_size) {
    call_answer a{};
    const std::int32_t code = of(d).call(what, a);
    put(text, text_size, a.text);
    return code;
  }

  static std::int32_t list_nothing(void*, std::int32_t (*)(void*, const asperity_listing*), char*, std::uint32_t) {
    return ASPERITY_UNSUPPORTED;  // child_driver lists
  }
  static std::int32_t make_nothing(const asperity_listing*, asperity_device**, char*, std::uint32_t) {
    return ASPERITY_UNSUPPORTED;  // child_driver makes
  }
  static void destroy(asperity_device* d) {
    call_answer ignored{};
    static_cast<void>(of(d).call(child_call::destroy, ignored));
  }
  static std::int32_t capabilities(const asperity_device* d, asperity_capabilities* out) {
    call_answer a{};
    const std::int32_t code = of(d).call(child_call::capabilities, a);
    if (code == ASPERITY_OK) abi::copy_out(a.capabilities, *out);
    return code;
  }
  static std::int32_t state(const asperity_device* d) { return of(d).state(); }
  static std::int32_t open(asperity_device* d, char* e, std::uint32_t n) { return set_up(child_call::open, d, e, n); }
  static std::int32_t arm(asperity_device* d, char* e, std::uint32_t n) { return set_up(child_call::arm, d, e, n); }
  static std::int32_t clear_fault(asperity_device* d, char* e, std::uint32_t n) {
    call_answer a{};
    const std::int32_t code = of(d).clear_fault(a);
    put(e, n, a.text);
    return code;
  }
  static std::int32_t disarm(asperity_device* d) { return of(d).disarm(); }
  static void close(asperity_device* d) {
    call_answer ignored{};
    static_cast<void>(of(d).call(child_call::close, ignored));
  }
  static std::int32_t read(asperity_device* d, std::int64_t now_ns, asperity_sample* out) {
    return of(d).read(now_ns, *out);
  }
  static std::int32_t write(asperity_device* d, std::int64_t now_ns, const asperity_command* c) {
    return of(d).write(now_ns, *c);
  }
  static std::int32_t fault_text(const asperity_device* d, char* text, std::uint32_t text_size) {
    if (const std::string why = of(d).what_happened(); !why.empty()) {
      abi::put_text({text, text_size}, why);
      return ASPERITY_OK;
    }
    call_answer a{};
    const std::int32_t code = of(d).call(child_call::fault_text, a);
    put(text, text_size, a.text);
    return code;
  }
};

// A driver of the C interface made of a link, which it keeps.
struct linked_driver {
  std::shared_ptr<child_link> link;
  std::string name;
  std::string version;
  std::string licence;
  std::string vendor;
  asperity_driver table{};

  explicit linked_driver(std::shared_ptr<child_link> l)
      : link(std::move(l)),
        name(link->hello().name),
        version(link->hello().version),
        licence(link->hello().licence),
        vendor(link->hello().vendor) {
    table.struct_size = sizeof table;
    table.abi_major = ASPERITY_ABI_MAJOR;
    table.abi_minor = ASPERITY_ABI_MINOR;
    table.maturity = link->hello().maturity;
    table.name = name.c_str();
    table.version = version.c_str();
    table.licence = licence.c_str();
    table.vendor = vendor.c_str();
    table.list = linked_calls::list_nothing;
    table.make = linked_calls::make_nothing;
    table.destroy = linked_calls::destroy;
    table.capabilities = linked_calls::capabilities;
    table.state = linked_calls::state;
    table.open = linked_calls::open;
    table.arm = linked_calls::arm;
    table.clear_fault = linked_calls::clear_fault;
    table.disarm = linked_calls::disarm;
    table.close = linked_calls::close;
    table.read = linked_calls::read;
    table.write = linked_calls::write;
    table.fault_text = linked_calls::fault_text;
  }
  linked_driver(const linked_driver&) = delete;
  linked_driver& operator=(const linked_driver&) = delete;
};

}  // namespace

class child_driver::body {
 public:
  body(std::shared_ptr<const driver_file> file, child_settings settings)
      : file_(std::move(file)), options_(std::move(settings)) {}

  // A process with the driver loaded. What the driver's table says is judged like that of any other.
  result<void> start() {
    auto link = std::make_shared<child_link>(file_, options_);
    if (const result<void> started = link->start(); !started) return started.error();
    auto driver = std::make_shared<linked_driver>(link);
    result<std::shared_ptr<const driver_module>> module =
        driver_module::from_table(&driver->table, file_->path().string(), {}, driver);
    if (!module) return module.error();
    fresh_ = std::move(link);
    module_ = std::move(module).value();
    name_ = module_->table().name;
    maturity_ = static_cast<driver_maturity>(module_->table().maturity);
    return {};
  }

  result<std::vector<device_listing>> list() {
    if (fresh_ == nullptr || !fresh_->what_happened().empty()) {
      if (const result<void> started = start(); !started) return started.error();
    }
    result<std::vector<listed_item>> items = fresh_->list();
    if (!items) {
      let_go();
      return items.error();
    }
    std::vector<device_listing> out;
    std::vector<std::unique_ptr<asperity_capabilities>> capabilities;
    for (const listed_item& item : *items) {
      device_listing d = from_listing(name_, item.listing);
      if (item.has_capabilities != 0) {
        capabilities.push_back(std::make_unique<asperity_capabilities>(item.capabilities));
        d.capabilities = abi::from_abi(*capabilities.back());
      }
      out.push_back(std::move(d));
    }
    listed_ = std::move(capabilities);
    return out;
  }

  result<plugin_device> make(const device_listing& which) {
    const result<asperity_listing> l = to_listing(which);
    if (!l) return l.error();
    if (fresh_ == nullptr || !fresh_->what_happened().empty()) {
      if (const result<void> started = start(); !started) return started.error();
    }
    const std::shared_ptr<child_link> link = std::move(fresh_);
    const std::shared_ptr<const driver_module> module = std::move(module_);
    call_answer a{};
    if (link->make(*l, a) != ASPERITY_OK) return error{error_code::io_failed, a.text};
    made_.push_back({link, link->last_words()});
    return plugin_device::adopt(module, reinterpret_cast<asperity_device*>(link.get()));
  }

  [[nodiscard]] std::string what_happened() const {
    std::string out;
    for (const made_device& d : made_) {
      const std::shared_ptr<child_link> link = d.link.lock();
      const std::string text = link ? link->what_happened() : *d.last_words;
      if (!text.empty()) out += (out.empty() ? "" : "; ") + name_ + ": " + text;
    }
    return out;
  }

  [[nodiscard]] std::string_view name() const noexcept { return name_; }
  [[nodiscard]] driver_maturity maturity() const noexcept { return maturity_; }

 private:
  struct made_device {
    std::weak_ptr<child_link> link;
    std::shared_ptr<const std::string> last_words;
  };

  void let_go() {
    module_.reset();
    fresh_.reset();
  }

  std::shared_ptr<const driver_file> file_;
  child_settings options_;
  std::string name_{};
  driver_maturity maturity_ = driver_maturity::simulated;
  std::shared_ptr<child_link> fresh_{};  // a process that has no device yet, and its table
  std::shared_ptr<const driver_module> module_{};
  std::vector<std::unique_ptr<asperity_capabilities>> listed_{};  // whose names the listings point to
  std::vector<made_device> made_{};
};

child_driver::child_driver(std::unique_ptr<body> b) noexcept : body_(std::move(b)) {}
child_driver::~child_driver() = default;

result<std::unique_ptr<child_driver>> child_driver::load(const std::filesystem::path& file, child_settings settings,
                                                         file_trust trust) {
  result<driver_file> opened = driver_file::open(file, trust);
  if (!opened) return opened.error();
  auto b = std::make_unique<body>(std::make_shared<const driver_file>(std::move(opened).value()), std::move(settings));
  if (const result<void> started = b->start(); !started) return started.error();
  return std::unique_ptr<child_driver>(new child_driver(std::move(b)));
}

std::string_view child_driver::name() const noexcept { return body_->name(); }
driver_maturity child_driver::maturity() const noexcept { return body_->maturity(); }
result<std::vector<device_listing>> child_driver::list() { return body_->list(); }
result<plugin_device> child_driver::make_plugin(const device_listing& which) { return body_->make(which); }
std::string child_driver::what_happened() const { return body_->what_happened(); }
result<any_device> child_driver::make(const device_listing& which) {
  result<plugin_device> d = make_plugin(which);
  if (!d) return d.error();
  return any_device(std::move(d).value());
}

}  // namespace asperity::plugin
