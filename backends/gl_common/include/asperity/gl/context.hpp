// A headless OpenGL context. Component asperity::gl.
//
// EGL is loaded when the first context is opened: a program that was built with asperity::gl starts on a machine
// without any OpenGL, and open_context() then says which step failed. Nothing here can end the process.
//
// Threads: a context belongs to one thread at a time, the one in which it was last made current. Each thread that draws
// has a context of its own; several contexts at once do not disturb each other. A thread that ends gives its context
// back.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "asperity/core/status.hpp"

namespace asperity::gl {

struct functions;      // entry points of OpenGL; backends include asperity/gl/functions.hpp
struct context_parts;  // EGL's side of a context

/// Which OpenGL a context speaks.
enum class dialect : std::uint8_t {
  automatic,  ///< core, or ES where there is none
  core,       ///< core profile, 4.5 down to 4.3
  es,         ///< OpenGL ES, 3.2 or 3.1
};

struct context_settings {
  /// Empty: the first device that works, real ones before software. Otherwise the index or a part of the name of a
  /// device of list_devices().
  std::string device{};
  gl::dialect dialect = dialect::automatic;
  /// Most memory that textures and buffers of this context may take on the device, bytes; 0: what the device has.
  std::size_t memory_limit_bytes = 0;
  /// Name or path of the library that EGL is loaded from.
  std::string egl_library = "libEGL.so.1";
};

/// Properties of an open context.
struct context_facts {
  std::string renderer;  ///< device and driver, as the driver names them
  std::string version;   ///< as the driver words it
  gl::dialect dialect = dialect::core;
  int major = 0, minor = 0;
  bool software = false;            ///< drawn by the processor (llvmpipe and its like): right, but slow
  bool double_precision = false;    ///< shaders can calculate in double precision
  bool persistent_mapping = false;  ///< buffers stay mapped while the device uses them
  bool robust = false;              ///< the driver reports when it lost the context
};

class context;
using context_ptr = std::shared_ptr<context>;

/// Opens a context; it is current in no thread yet.
/// @return unsupported, with the step that failed - loading EGL, finding a vendor, starting a driver, a new enough
///         OpenGL - and how to mend it | invalid_argument where no device has the name that was asked for
[[nodiscard]] result<context_ptr> open_context(const context_settings& settings = {});

class context : public std::enable_shared_from_this<context> {
 public:
  explicit context(std::unique_ptr<context_parts> parts) noexcept;
  /// Frees everything that was made in it.
  ~context();
  context(const context&) = delete;
  context& operator=(const context&) = delete;
  context(context&&) = delete;
  context& operator=(context&&) = delete;

  [[nodiscard]] const context_facts& facts() const noexcept;

  /// Makes the context current in this thread; free where it is already.
  /// @return ok | backend_failed (current in another thread, or lost)
  [[nodiscard]] status make_current() noexcept;
  /// Gives the context back, so that another thread can take it. Does nothing where it is not current in this thread.
  void release() noexcept;
  [[nodiscard]] bool is_current() const noexcept;

  /// Asks the driver. @pre current in this thread   @return ok | backend_failed (lost: nothing in it can be used again)
  [[nodiscard]] status check() noexcept;
  /// Marks the context as lost, for tests of how that is handled.
  void simulate_loss() noexcept { lost_ = true; }

  /// Memory that textures and buffers take on the device, bytes.
  [[nodiscard]] std::size_t device_bytes() const noexcept { return device_bytes_; }
  /// Counts memory before it is taken. @return limit_exceeded where the context's limit stands in the way
  [[nodiscard]] result<void> take_memory(std::size_t bytes, const std::string& what);
  void give_memory_back(std::size_t bytes) noexcept { device_bytes_ -= bytes; }
  void limit_memory(std::size_t bytes) noexcept { memory_limit_bytes_ = bytes; }

  [[nodiscard]] const functions& gl() const noexcept;
  [[nodiscard]] context_parts& parts() noexcept { return *parts_; }

 private:
  std::unique_ptr<context_parts> parts_;
  std::size_t memory_limit_bytes_ = 0;
  std::atomic<std::size_t> device_bytes_ = 0;
  std::atomic<bool> lost_ = false;
};

/// Makes a context current as long as the scope lasts; afterwards the thread has the context that it had before, or
/// none. For set-up. A tick calls make_current() and stays.
class current_scope {
 public:
  explicit current_scope(context_ptr c) noexcept;
  ~current_scope();
  current_scope(const current_scope&) = delete;
  current_scope& operator=(const current_scope&) = delete;
  /// The answer of make_current().
  [[nodiscard]] status state() const noexcept { return state_; }

 private:
  context_ptr context_;
  void* display_ = nullptr;  ///< of the context that was current before, which need not be one of ours
  void* draw_ = nullptr;
  void* read_ = nullptr;
  void* before_ = nullptr;
  status state_;
};

}  // namespace asperity::gl
