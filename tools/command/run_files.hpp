// The files that a session leaves.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "device_recorder.hpp"
#include "recording.hpp"
#include "run_command.hpp"
#include "session.hpp"
#include "session_summary.hpp"

namespace asperity::command {

/// All of them are opened before the session begins, and all are written before one appears.
class session_files {
 public:
  /// @return io_failed
  [[nodiscard]] static result<session_files> open(const run_command& options);

  /// The recorder of the device, or null where none was asked for. It stays where it is.
  [[nodiscard]] device_recorder* recorder() noexcept { return recorder_.get(); }

  /// One device tick, outside of it. @return io_failed
  [[nodiscard]] result<void> add(const session_record& tick);

  /// @return io_failed, and nothing appears
  [[nodiscard]] result<void> close(const run_command& options, const session_outcome& ended,
                                   const session_summary& summary);

  /// Closes the recordings of a session that will not come to its end, as far as they go; a plot is left out. Nothing
  /// where they are closed already, or where the session had not begun. @return one clause on what became of them
  [[nodiscard]] std::string rescue();

 private:
  std::unique_ptr<device_recorder> recorder_;
  std::optional<recording> record_;
  std::optional<output_file> plot_;
  std::optional<session_curves> curves_;
  bool begun_ = false;
  bool closed_ = false;
};

}  // namespace asperity::command
