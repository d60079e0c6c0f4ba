#include "run_report.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <system_error>
#include <thread>

#include "gpu_report.hpp"
#include "interrupt.hpp"
#include "material_option.hpp"
#include "model_report.hpp"
#include "options.hpp"
#include "statistics.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

json pose_json(const pose& T) {
  const auto q = to_xyzw(T.rotation);
  return {T.position.x, T.position.y, T.position.z, q[0], q[1], q[2], q[3]};
}

bool keeps_rate(const loop_times& times) {
  return static_cast<double>(times.over_period) <= allowed_over_period * static_cast<double>(times.seconds.size());
}

json loop_json(double rate_hz, const loop_times& times, const time_summary& measured) {
  return {{"rate", rate_hz},           {"ticks", times.ticks},          {"idle", times.idle},
          {"late", times.late},        {"skipped", times.skipped},      {"over_period", times.over_period},
          {"kept", keeps_rate(times)}, {"tick_time", to_json(measured)}};
}

std::string loop_text(double rate_hz, const loop_times& times, const time_summary& measured, bool real_time) {
  return rate_text(rate_hz) + ", " + std::to_string(times.ticks) + " ticks, " +
         (real_time ? std::to_string(times.late) + " late, " + std::to_string(times.skipped) + " skipped"
                    : std::to_string(times.over_period) + " longer than " + time_text(1.0 / rate_hz)) +
         "; " + to_text(measured);
}

// The virtual clock waits for every tick, so nothing that was felt or recorded depends on this.
std::string rate_warning(const run_command& options, const loop_times& contact, const time_summary& measured) {
  if (keeps_rate(contact) || options.render.backend == "exact") return "";
  return std::string("  warning: the contact loop ") +
         (clock_of(options) == "real" ? "did not keep " : "would not keep ") + rate_text(options.contact_rate_hz) +
         (clock_of(options) == "real" ? "" : " in real time") + ": " + std::to_string(contact.over_period) + " of " +
         std::to_string(contact.seconds.size()) + " ticks took longer than " +
         time_text(1.0 / options.contact_rate_hz) + "; " +
         advice_for(rate_within(measured.p99_s), more_threads(options.render, std::thread::hardware_concurrency())) +
         "\n";
}

json rates_json(const rate_report& r) {
  const auto seconds = [](std::int64_t ns) { return 1e-9 * static_cast<double>(ns); };
  return {{"lost_periods", r.lost_periods},
          {"worst_lost_share", r.worst_lost_share},
          {"lapses", r.lapses},
          {"longest_gap", seconds(r.longest_gap_ns)},
          {"contact_lapses", r.contact_lapses},
          {"surprises", r.surprises},
          {"oldest_contact", seconds(r.oldest_contact_ns)},
          {"lowest_scale", r.lowest_scale},
          {"silent", seconds(r.silent_ns)}};
}

std::string rates_text(const rate_report& r) {
  const auto ms = [](std::int64_t ns) { return brief(1e-6 * static_cast<double>(ns)) + " ms"; };
  return std::to_string(r.lost_periods) + " periods without a tick, at most " + brief(100.0 * r.worst_lost_share) +
         " % of them; longest gap " + ms(r.longest_gap_ns) + ", oldest contact " + ms(r.oldest_contact_ns);
}

std::string late_warning(const rate_report& r) {
  return "  warning: the loops were late: the wrench was scaled down to " + brief(100.0 * r.lowest_scale) +
         " % at times, and was zero for " + brief(1e-9 * static_cast<double>(r.silent_ns)) + " s (" +
         std::to_string(r.lapses) + " gaps of the device loop, " + std::to_string(r.contact_lapses) +
         " of the contact loop)\n";
}

// The flight recorder. What was not finite is null, as JSON has no word for it.
json fault_json(const session_outcome& ended) {
  if (ended.fault == gate_fault::none) return nullptr;
  json ticks = json::array();
  for (const flight_entry& e : ended.last_ticks) {
    ticks.push_back(
        {{"time", 1e-9 * static_cast<double>(e.time_ns)},
         {"sample", {{"sequence", e.seen.sequence}, {"pose", pose_json(e.seen.T_dh)}}},
         {"wanted", {{"force", command::to_json(e.wanted.force)}, {"torque", command::to_json(e.wanted.torque)}}},
         {"sent", {{"force", command::to_json(e.sent.force)}, {"torque", command::to_json(e.sent.torque)}}}});
  }
  return {{"cause", to_string(ended.fault)}, {"time", ended.ended_at_s}, {"last_ticks", ticks}};
}

json replay_json(const std::optional<replay_outcome>& replay) {
  if (!replay) return nullptr;
  return {{"device", replay->device},
          {"ticks", replay->ticks},
          {"cut", replay->cut},
          {"differences", replay->differences},
          {"first_difference", replay->first_difference_s ? json(*replay->first_difference_s) : json()}};
}

const char* to_string(grant g) {
  switch (g) {
    case grant::not_asked:
      return "not_asked";
    case grant::granted:
      return "granted";
    case grant::refused:
      return "refused";
    case grant::unsupported:
      return "unsupported";
  }
  return "unknown";
}

json thread_json(const thread_grants& t) {
  return {{"scheduling", to_string(t.scheduling)},
          {"priority", t.scheduling == grant::granted ? json(t.priority) : json()},
          {"affinity", to_string(t.affinity)},
          {"processor", t.affinity == grant::granted ? json(t.processor) : json()}};
}

json real_time_json(const std::optional<real_time_grants>& got) {
  if (!got) return nullptr;
  return {{"device_thread", thread_json(got->device)},
          {"contact_thread", thread_json(got->contact)},
          {"memory_lock", to_string(got->memory)},
          {"later_memory", got->later_memory}};
}

std::string refusal_text(int error) { return "refused (" + std::generic_category().message(error) + ")"; }

std::string thread_text(const thread_grants& t) {
  std::string out = t.scheduling == grant::granted   ? "SCHED_FIFO " + std::to_string(t.priority)
                    : t.scheduling == grant::refused ? "SCHED_FIFO " + refusal_text(t.scheduling_error)
                                                     : "ordinary class";
  if (t.affinity == grant::granted) out += " on processor " + std::to_string(t.processor);
  if (t.affinity == grant::refused) out += ", processor of its own " + refusal_text(t.affinity_error);
  return out;
}

json clutch_json(const run_command& options, const session_summary& summary) {
  if (options.clutch_button == 0) return nullptr;
  return {{"button", options.clutch_button},
          {"told", summary.buttons_told()},
          {"let_go", static_cast<double>(summary.ticks_let_go()) / options.device_rate_hz}};
}

std::string clutch_text(const run_command& options, const session_summary& summary) {
  return "button " + std::to_string(options.clutch_button) + ", let go for " +
         brief(static_cast<double>(summary.ticks_let_go()) / options.device_rate_hz) + " s";
}

json weight_json(const run_command& options) {
  const std::optional<weight_settings> w = weight_of(options.weight);
  if (!w) return nullptr;
  return {{"mass", w->mass_kg}, {"centre", command::to_json(w->centre_h)}};
}

json transient_json(const run_command& options, const session_summary& summary) {
  const std::optional<transient_settings> t = transient_of(options.transient);
  if (!t) return nullptr;
  return {{"amplitude", t->amplitude_n_s_per_m},
          {"frequency", t->frequency_hz},
          {"decay", t->decay_s},
          {"first_touches", summary.first_touches()}};
}

json velocity_json(const run_command& options, const session_summary& summary) {
  return {{"asked", options.velocity},
          {"device_ticks", summary.ticks_with(velocity_source::device)},
          {"window_ticks", summary.ticks_with(velocity_source::window)},
          {"refused", summary.velocity_refused()}};
}

// What was asked for and not had.
std::string velocity_warning(const run_command& options, const session_summary& summary) {
  const std::uint64_t missed = summary.ticks_with(velocity_source::window);
  if (velocity_of(options) != velocity_source::device || missed == 0) return "";
  return "  warning: the handle's velocity was that of a window of its poses in " + std::to_string(missed) +
         " ticks: the device " +
         (summary.velocity_refused() ? "told one that does not go with its poses" : "told none of its own") + "\n";
}

json friction_json(const run_command& options) {
  const std::optional<friction_settings> mu = friction_of(options.friction);
  if (!mu) return {};
  return {{"static", mu->static_coefficient}, {"dynamic", mu->dynamic_coefficient}};
}

json local_model_json(const run_command& options) {
  if (formulation_name(options.render) != "planes") return {};
  return !options.no_local_model;
}

json surfaces_json(const surface_pairs& pairs) {
  json out = json::array();
  for (const std::optional<surface_pair>& p : pairs) out.push_back(p ? to_json(*p) : json());
  for (const mapped_pair& m : pairs.mapped) {
    json pair = to_json(m.pair);
    pair["of_probe"] = m.of_probe;
    pair["of_fixed"] = m.of_body;
    out[m.body]["others"].push_back(std::move(pair));
  }
  return out;
}

std::string replay_text(const replay_outcome& replay) {
  const std::string what = replay.device + ", " + std::to_string(replay.ticks) + " ticks on record" +
                           (replay.cut ? ", cut off before its end; " : "; ");
  if (!replay.first_difference_s) return what + "every call and every command as it was then";
  return what + "from " + brief(*replay.first_difference_s) + " s on the commands are others than then";
}

}  // namespace

std::string to_text(const real_time_grants& got) {
  return "device loop " + thread_text(got.device) + "; contact loop " + thread_text(got.contact) + "; memory " +
         (got.memory == grant::granted   ? got.later_memory ? "locked" : "locked as it was at the start"
          : got.memory == grant::refused ? "lock " + refusal_text(got.memory_error)
                                         : "not locked");
}

answer report(const run_command& options, const session_findings& found) {
  const auto& [poses, ended, summary, memory, coupling, rate, probe, replay, driver, surfaces] = found;
  const bool real_time = clock_of(options) == "real";
  const time_summary contact = summarise(ended.contact.seconds);
  const time_summary device = summarise(ended.device.seconds);
  json T_wb = json::array();
  for (const pose& T : poses.T_wb) T_wb.push_back(pose_json(T));

  answer out;
  out.document = {{"probe", options.probe},
                  {"fixed", options.fixed},
                  {"start", {{"probe_pose", pose_json(*poses.T_wa)}, {"fixed_poses", T_wb}}},
                  {"device", options.device},
                  {"clock", clock_of(options)},
                  {"motion", options.motion},
                  {"seed", options.seed},
                  {"seconds", ended.ended_at_s},
                  {"backend", options.render.backend},
                  {"formulation", formulation_name(options.render)},
                  {"gradient_scheme", gradient_name(options.render)},
                  {"grid", grid_json(options.render)},
                  {"lookup", lookup_json(options.render)},
                  {"coupling", command::to_json(coupling, probe)},
                  {"scale", options.scale},
                  {"clutch", clutch_json(options, summary)},
                  {"weight", weight_json(options)},
                  {"transient", transient_json(options, summary)},
                  {"velocity", velocity_json(options, summary)},
                  {"friction", friction_json(options)},
                  {"local_model", local_model_json(options)},
                  {"surfaces", surfaces_json(surfaces)},
                  {"moves", options.moves}};
  out.document.update(summary.to_json());
  out.document["contact_loop"] = loop_json(options.contact_rate_hz, ended.contact, contact);
  out.document["rate_check"] = rate ? command::to_json(*rate) : json();
  out.document["device_loop"] = loop_json(options.device_rate_hz, ended.device, device);
  out.document["tick_time_is"] = clock_of(options) == "virtual" ? "cpu" : "wall";
  out.document["memory"] = {{"models", memory.models}, {"renderer", memory.renderer}};
  if (memory.gpu) out.document["gpu"] = command::to_json(*memory.gpu);
  out.document["rates"] = rates_json(ended.rates);
  out.document["rejected_samples"] = ended.rejected_samples;
  out.document["lost_records"] = ended.lost_records;
  out.document["fault"] = to_string(ended.fault);
  out.document["fault_record"] = fault_json(ended);
  out.document["driver_fault"] = driver.empty() ? json() : json(driver);
  out.document["interrupted"] = ended.interrupted;
  out.document["signal"] = ended.interrupted ? json(signal_name(stop_signal())) : json();
  out.document["real_time"] = real_time_json(ended.real_time);
  out.document["recording"] = options.record.empty() ? json() : json(options.record);
  out.document["device_recording"] = options.record_device.empty() ? json() : json(options.record_device);
  out.document["replay"] = replay_json(replay);
  out.document["plot"] = options.plot.empty() ? json() : json(options.plot);
  out.document["units"] = "SI";

  out.text = printable(file_stem(options.probe) + " felt on " + file_stem(options.fixed.front())) + ", " +
             brief(ended.ended_at_s) + " s, " + (is_simulated(options) ? options.motion + ", " : "") +
             clock_of(options) + " clock\n" + summary.to_text();
  out.text += row("coupling", to_text(coupling, probe));
  if (options.scale != 1.0)
    out.text += row("scale", brief(options.scale) + " m of the world for a metre of the device");
  if (options.clutch_button != 0) out.text += row("clutch", clutch_text(options, summary));
  if (const auto w = weight_of(options.weight)) {
    out.text += row("weight", brief(1e3 * w->mass_kg) + " g of the handle, held by the motors");
  }
  if (const auto t = transient_of(options.transient)) {
    out.text += row("transient",
                    brief(t->frequency_hz) + " Hz at " + std::to_string(summary.first_touches()) + " first touches");
  }
  if (velocity_of(options) != velocity_source::poses) out.text += row("velocity", "by " + options.velocity);
  if (const auto mu = friction_of(options.friction); mu && mu->any()) {
    out.text +=
        row("friction", brief(mu->static_coefficient) + " at rest, " + brief(mu->dynamic_coefficient) + " slipping");
  }
  if (options.no_local_model) out.text += row("local model", "none: planes stay between two contacts");
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (!surfaces[i]) continue;
    const std::string name = printable(file_stem(options.fixed[i]));
    out.text += row("surfaces", name + ": " + to_text(*surfaces[i]));
    for (const mapped_pair& m : surfaces.mapped) {
      if (m.body != i) continue;
      out.text += row("", "material " + std::to_string(m.of_probe) + " of the probe, " + std::to_string(m.of_body) +
                              " of " + name + ": " + to_text(m.pair));
    }
  }
  for (const std::string& move : options.moves) out.text += row("moves", printable(move));
  out.text += row("contact loop", loop_text(options.contact_rate_hz, ended.contact, contact, real_time));
  out.text += row("device loop", loop_text(options.device_rate_hz, ended.device, device, real_time));
  out.text += row("rates", rates_text(ended.rates));
  if (ended.real_time) out.text += row("real time", to_text(*ended.real_time));
  out.text += row("memory", memory_text(memory.models) + " models, " + memory_text(memory.renderer) + " renderer");
  if (memory.gpu) out.text += to_text(*memory.gpu);
  if (replay) out.text += row("replay", replay_text(*replay));
  out.text += row("faults", to_string(ended.fault));
  if (!driver.empty()) out.text += row("driver", driver);
  if (!options.record.empty()) out.text += row("recording", options.record);
  if (!options.record_device.empty()) out.text += row("device recording", options.record_device);
  if (!options.plot.empty()) out.text += row("plot", options.plot);
  if (!summary.touched())
    out.text += "  warning: the probe never touched anything: lower it with --press or --probe-pose\n";
  out.text += summary.wall().warnings();
  out.text += summary.vibration_warning();
  out.text += velocity_warning(options, summary);
  if (options.clutch_button != 0 && !summary.buttons_told()) {
    out.text += "  warning: the device told nothing of its buttons: the clutch was not used\n";
  }
  out.text += rate_warning(options, ended.contact, contact);
  if (ended.rates.lowest_scale < 1.0) out.text += late_warning(ended.rates);
  if (ended.lost_records > 0) {
    out.text += "  warning: " + std::to_string(ended.lost_records) + " ticks are missing from the recording\n";
  }

  if (ended.fault != gate_fault::none) {
    out.exit_status = exit_failed;
    out.complaint = "the output gate shut after " + brief(ended.ended_at_s) + " s (" + to_string(ended.fault) +
                    "): the wrench is zero; see the last rows of the recording" +
                    (driver.empty() ? "" : "; driver " + driver);
  } else if (ended.interrupted) {
    out.exit_status = exit_interrupted();
    out.complaint = "interrupted by " + signal_name(stop_signal()) + " after " + brief(ended.ended_at_s) +
                    " s: the wrench is zero, the device is disarmed, the recordings are closed";
  }
  if (ended.armed_at_end) {
    out.exit_status = exit_failed;
    out.complaint = "the device did NOT take its disarm at the end of the session: switch it off";
  }
  return out;
}

}  // namespace asperity::command
