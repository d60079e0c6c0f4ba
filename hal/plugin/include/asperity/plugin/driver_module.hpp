// A driver's shared object, loaded and checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/device/driver_abi.h"
#include "asperity/plugin/driver_file.hpp"
#include "asperity/plugin/table_check.hpp"

namespace asperity::plugin {

/// Receives what a driver has to say outside a tick: ASPERITY_LOG_..., the driver's name, one line. Called from any
/// thread, several at once.
using log_sink = std::function<void(std::uint32_t level, std::string_view driver, std::string_view line)>;

/// A table that was checked, and the code behind it. Unloaded when the last driver and device that came from it are
/// gone, so that nothing ever points into unloaded code.
class driver_module {
 public:
  /// Loads and checks a shared object. Its code runs from here on, with the rights of this process and in the middle of
  /// it: load only what you trust like this program itself. child_driver runs a driver in a process of its own.
  [[nodiscard]] static result<std::shared_ptr<const driver_module>> load(const std::filesystem::path& file,
                                                                         log_sink log = {},
                                                                         file_trust trust = file_trust::owner_only);
  /// As load(), with the kind of fault told apart.
  [[nodiscard]] static std::shared_ptr<const driver_module> load(const std::filesystem::path& file, log_sink log,
                                                                 load_failure& failure,
                                                                 file_trust trust = file_trust::owner_only);
  /// The same for a file that was opened and judged.
  [[nodiscard]] static std::shared_ptr<const driver_module> load(driver_file file, log_sink log, load_failure& failure);
  /// The same for a driver that is part of this program. @pre the table outlives the module, or `owner` keeps it
  [[nodiscard]] static result<std::shared_ptr<const driver_module>> from_table(const asperity_driver* table,
                                                                               std::string where, log_sink log = {},
                                                                               std::shared_ptr<const void> owner = {});

  driver_module(const driver_module&) = delete;
  driver_module& operator=(const driver_module&) = delete;
  ~driver_module();

  /// Complete: what an older driver does not have is NULL.
  [[nodiscard]] const asperity_driver& table() const noexcept { return table_; }
  /// The file, or what the caller of from_table() said.
  [[nodiscard]] const std::string& where() const noexcept { return where_; }

 private:
  using handle = std::unique_ptr<void, int (*)(void*)>;

  driver_module(handle library, const asperity_driver& table, std::string where, log_sink log,
                std::shared_ptr<const void> owner);
  [[nodiscard]] static std::shared_ptr<const driver_module> adopt(handle library, const asperity_driver* table,
                                                                  std::string where, log_sink log,
                                                                  load_failure& failure,
                                                                  std::shared_ptr<const void> owner = {});
  [[nodiscard]] result<void> attach();
  static void log_line(void* context, std::uint32_t level, const char* text) noexcept;

  std::shared_ptr<const void> owner_;
  handle library_;
  asperity_driver table_;
  std::string where_;
  log_sink log_;
  asperity_host host_{};
  bool attached_ = false;
};

}  // namespace asperity::plugin
