#include "asperity/plugin/driver_module.hpp"

#include <atomic>
#include <cstring>
#include <dlfcn.h>
#include <utility>

#include "asperity/device/driver_conversion.hpp"
#include "guarded_call.hpp"

namespace asperity::plugin {
namespace {

int keep(void* /*library*/) { return 0; }

std::string linker_says() {
  const char* text = ::dlerror();
  return text != nullptr ? text : "the dynamic linker gives no reason";
}

// A name of the descriptor that was never given to the linker before: it takes a name that it knows for the library
// that it knows, and a descriptor's number is used again. Each of the bits of a counter is written as a slash or as a
// dot.
std::string name_for_linker(int descriptor) {
  static std::atomic<std::uint64_t> next{1};
  std::string name = "/proc/self/fd/";
  for (std::uint64_t n = next++; n != 0; n >>= 1U) name += (n & 1U) != 0 ? "./" : "/";
  return name + std::to_string(descriptor);
}

}  // namespace

driver_module::driver_module(handle library, const asperity_driver& table, std::string where, log_sink log,
                             std::shared_ptr<const void> owner)
    : owner_(std::move(owner)),
      library_(std::move(library)),
      table_(table),
      where_(std::move(where)),
      log_(std::move(log)) {
  host_ = abi::blank<asperity_host>();
  host_.abi_version = ASPERITY_ABI_VERSION;
  host_.context = this;
  host_.log = log_line;
}

driver_module::~driver_module() {
  if (attached_ && table_.detach != nullptr) {
    static_cast<void>(guarded_call([this] { table_.detach(&host_); }));
  }
}

void driver_module::log_line(void* context, std::uint32_t level, const char* text) noexcept {
  const auto& self = *static_cast<const driver_module*>(context);
  if (!self.log_ || text == nullptr) return;
  static_cast<void>(
      guarded_call([&] { self.log_(level, self.table_.name, std::string_view(text, ::strnlen(text, 4096))); }));
}

result<void> driver_module::attach() {
  if (table_.attach == nullptr) return {};
  char text[ASPERITY_TEXT_SIZE] = "";
  const auto code = guarded_call([&] { return table_.attach(&host_, text, sizeof text); });
  attached_ = code == ASPERITY_OK;
  if (attached_) return {};
  return error{error_code::io_failed, driver_error(code, text)};
}

std::shared_ptr<const driver_module> driver_module::adopt(handle library, const asperity_driver* table,
                                                          std::string where, log_sink log, load_failure& failure,
                                                          std::shared_ptr<const void> owner) {
  if (std::optional<table_problem> problem = find_problem(table)) {
    failure = {problem->fault, {error_code::bad_format, where + ": " + problem->message}};
    return nullptr;
  }
  const std::shared_ptr<driver_module> m(
      new driver_module(std::move(library), abi::copy_in(*table), std::move(where), std::move(log), std::move(owner)));
  if (const result<void> attached = m->attach(); !attached) {
    failure = {table_fault::refused,
               {attached.error().code, m->where_ + ": the driver refuses its host: " + attached.error().message}};
    return nullptr;
  }
  return m;
}

std::shared_ptr<const driver_module> driver_module::load(driver_file file, log_sink log, load_failure& failure) {
  const std::string where = file.path().string();
  handle library(::dlopen(name_for_linker(file.descriptor()).c_str(), RTLD_NOW | RTLD_LOCAL), ::dlclose);
  if (library == nullptr) {
    static_cast<void>(library.release());
    failure = {table_fault::not_loadable, {error_code::io_failed, where + ": cannot be loaded: " + linker_says()}};
    return nullptr;
  }
  void* const symbol = ::dlsym(library.get(), ASPERITY_ENTRY_NAME);
  if (symbol == nullptr) {
    failure = {table_fault::no_entry, {error_code::bad_format, where + ": does not export " ASPERITY_ENTRY_NAME}};
    return nullptr;
  }
  const auto entry = reinterpret_cast<decltype(&asperity_driver_entry)>(symbol);
  const asperity_driver* table = nullptr;
  static_cast<void>(guarded_call([&] { table = entry(ASPERITY_ABI_VERSION); }));
  return adopt(std::move(library), table, where, std::move(log), failure);
}

std::shared_ptr<const driver_module> driver_module::load(const std::filesystem::path& file, log_sink log,
                                                         load_failure& failure, file_trust trust) {
  std::optional<driver_file> opened = driver_file::open(file, trust, failure);
  return opened ? load(std::move(*opened), std::move(log), failure) : nullptr;
}

result<std::shared_ptr<const driver_module>> driver_module::load(const std::filesystem::path& file, log_sink log,
                                                                 file_trust trust) {
  load_failure failure{};
  std::shared_ptr<const driver_module> m = load(file, std::move(log), failure, trust);
  if (m == nullptr) return failure.why;
  return m;
}

result<std::shared_ptr<const driver_module>> driver_module::from_table(const asperity_driver* table, std::string where,
                                                                       log_sink log,
                                                                       std::shared_ptr<const void> owner) {
  load_failure failure{};
  std::shared_ptr<const driver_module> m =
      adopt(handle(nullptr, keep), table, std::move(where), std::move(log), failure, std::move(owner));
  if (m == nullptr) return failure.why;
  return m;
}

}  // namespace asperity::plugin
