// How the rows of a session become the bytes of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "asperity/control/session_record.hpp"
#include "asperity/core/status.hpp"

namespace asperity::command {

/// A format of recordings. Bytes are appended to `out` in the order in which they stand in the file, and only what belongs
/// to the session itself is written: the same session gives the same bytes.
class row_encoder {
 public:
  row_encoder() = default;
  row_encoder(const row_encoder&) = delete;
  row_encoder& operator=(const row_encoder&) = delete;
  virtual ~row_encoder() = default;

  virtual void begin(std::string& out) = 0;
  /// @return limit_exceeded where the format holds no more rows
  [[nodiscard]] virtual result<void> add(std::string& out, const session_record& tick) = 0;
  /// What follows the rows, a part at a time. @return whether there is more
  [[nodiscard]] virtual bool end(std::string& out) = 0;
  /// Whether what was written so far only stood in for the file, in case of a kill, and end() writes the file itself.
  [[nodiscard]] virtual bool starts_anew() const noexcept { return false; }
  /// A description that belongs beside the file, and the name of its file; empty where the format has none.
  struct companion {
    std::string name, text;
  };
  [[nodiscard]] virtual companion beside(const std::filesystem::path&) const { return {}; }
};

/// The format that a name asks for: .npz and .mcap, otherwise comma-separated values.
[[nodiscard]] std::unique_ptr<row_encoder> encoder_for(const std::filesystem::path& file);

[[nodiscard]] std::unique_ptr<row_encoder> make_csv_encoder();
[[nodiscard]] std::unique_ptr<row_encoder> make_npz_encoder();
[[nodiscard]] std::unique_ptr<row_encoder> make_mcap_encoder();

}  // namespace asperity::command
