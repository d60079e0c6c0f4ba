// Checks of a driver's table and answers, made before they are used.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "asperity/device/driver_abi.h"

namespace asperity::plugin {

/// What is wrong with a driver's table.
enum class table_fault : std::uint8_t {
  not_loadable,  ///< the file is not a shared object that can be loaded here
  no_entry,      ///< it does not export asperity_driver_entry
  refused,       ///< the entry gave no table for this host
  struct_size,   ///< shorter than its mandatory part, or not a size
  abi_major,     ///< made for another major version
  mandatory,     ///< a mandatory function is missing
  text,          ///< name, version, licence or vendor is missing or not text
};

[[nodiscard]] const char* to_string(table_fault f) noexcept;

/// A fault and one sentence about it.
struct table_problem {
  table_fault fault;
  std::string message;
};

/// The first thing that is wrong with the answer of a driver's entry, or nothing. Reads no field beyond the table's
/// struct_size, and calls nothing.
[[nodiscard]] std::optional<table_problem> find_problem(const asperity_driver* table);

/// The first thing that is wrong with what a driver says that its device can do: a number that is not finite or is
/// negative, axes that do not exist, a continuous limit above its peak, a box inside out, a name without an end.
[[nodiscard]] std::optional<std::string> find_problem(const asperity_capabilities& c);

/// The first thing that is wrong with what a driver says is plugged in.
[[nodiscard]] std::optional<std::string> find_problem(const asperity_listing& l);

}  // namespace asperity::plugin
