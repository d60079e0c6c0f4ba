// A file judged as a driver without running anything in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace asperity::plugin {

/// Fills all of `into` from this place of a file. @return false where the file does not reach so far
using file_reader = std::function<bool(std::uint64_t offset, std::span<std::byte> into)>;

/// What keeps a file from being a driver that can be loaded here.
struct elf_problem {
  bool no_entry;  ///< a shared object for this machine that does not export the driver's function
  std::string message;
};

/// Looks for asperity_driver_entry as the dynamic linker does: program headers, dynamic section, hash table, symbol.
/// Every offset, size and count is checked against the file before it is used, and the work is bounded, whatever the
/// file says. The file is not mapped and nothing in it runs. @return nothing where it can be loaded as a driver
[[nodiscard]] std::optional<elf_problem> find_elf_problem(const file_reader& read);

}  // namespace asperity::plugin
