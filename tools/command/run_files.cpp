#include "run_files.hpp"

#include <filesystem>
#include <string>
#include <utility>

#include "options.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

std::string plot_title(const run_command& options, const session_summary& summary) {
  const char* const does = options.motion == "press"   ? " presses on "
                           : options.motion == "twist" ? " twists on "
                           : options.motion == "free"  ? " wanders over "
                                                       : " scrubs ";
  const std::string who = printable(file_stem(options.probe) + does + file_stem(options.fixed.front()));
  if (!summary.touched()) return who + " and never touches it.";
  return who + ": up to " + brief(summary.largest_hand_force_n()) + " N and " +
         brief(1e3 * summary.largest_hand_torque_n_m()) + " mN m on the hand, " + brief(summary.mean_contacts()) +
         (brief(summary.mean_contacts()) == "1" ? " contact" : " contacts on average") + " while touching.";
}

std::string contacts_in_words(const render_options& options) {
  const std::string formulation = formulation_name(options);
  if (formulation == "planes") return "contacts as support planes";
  return formulation == "least-motion" ? "contacts as one potential" : "contacts as in the paper";
}

std::string plot_caption(const run_command& options) {
  return (is_simulated(options) ? "Simulated device"
          : is_replay(options)
              ? "Replay of " + printable(std::filesystem::path(replayed_file(options)).filename().string())
              : printable(options.device)) +
         " at " + rate_text(options.device_rate_hz) + ", contact loop at " + rate_text(options.contact_rate_hz) + ", " +
         clock_of(options) + " clock, " + contacts_in_words(options.render) +
         (is_simulated(options) ? ", seed " + std::to_string(options.seed) : "") +
         "; world axes, torque about the probe's centre of mass.";
}

}  // namespace

result<session_files> session_files::open(const run_command& options) {
  session_files files;
  if (!options.record.empty()) {
    result<recording> opened = recording::create(options.record);
    if (!opened) return opened.error();
    files.record_.emplace(std::move(opened).value());
  }
  if (!options.record_device.empty()) {
    result<std::unique_ptr<device_recorder>> opened = device_recorder::create(options.record_device);
    if (!opened) return opened.error();
    files.recorder_ = std::move(opened).value();
  }
  if (!options.plot.empty()) {
    result<output_file> opened = output_file::create(options.plot);
    if (!opened) return opened.error();
    files.plot_.emplace(std::move(opened).value());
    files.curves_.emplace(static_cast<std::size_t>(seconds_of(options) * options.device_rate_hz));
  }
  return files;
}

result<void> session_files::add(const session_record& tick) {
  begun_ = true;
  if (curves_) curves_->add(tick);
  if (recorder_) {
    if (const result<void> written = recorder_->drain(); !written) return written;
  }
  return record_ ? record_->add(tick) : result<void>();
}

result<void> session_files::close(const run_command& options, const session_outcome& ended,
                                  const session_summary& summary) {
  closed_ = true;
  if (plot_) {
    const bool svg = extension_error(options.plot, {".svg"}).empty();
    const plot_page page = curves_->page(plot_title(options, summary), plot_caption(options));
    if (const result<void> drawn = draw(page, svg ? plot_format::svg : plot_format::png, *plot_); !drawn) return drawn;
  }
  if (recorder_) {
    const recorded_end why = ended.interrupted ? recorded_end::interrupted : recorded_end::stopped;
    if (const result<void> written = recorder_->finish(why, ended.device.ticks); !written) return written;
  }
  if (record_) {
    if (const result<void> closed = record_->close(); !closed) return closed;
  }
  if (recorder_) {
    if (const result<void> closed = recorder_->commit(); !closed) return closed;
  }
  return plot_ ? plot_->commit() : result<void>();
}

std::string session_files::rescue() {
  plot_.reset();
  if (closed_) return "its recordings were closed before";
  if (!begun_ || (!record_ && !recorder_)) {
    record_.reset();
    recorder_.reset();
    return {};
  }
  closed_ = true;
  bool kept = true;
  if (recorder_) {
    const result<void> ended = recorder_->finish(recorded_end::not_reported, 0);
    kept = ended && recorder_->commit();
  }
  if (record_) kept = record_->close() && kept;
  return kept ? "its recordings hold what came before" : "its recordings could not all be closed";
}

}  // namespace asperity::command
