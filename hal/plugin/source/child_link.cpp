#include "child_link.hpp"

#include <algorithm>
#include <utility>

#include "asperity/device/driver_conversion.hpp"
#include "asperity/plugin/futex.hpp"
#include "asperity/plugin/table_check.hpp"

namespace asperity::plugin {
namespace {

constexpr int most_waits = 2;                             // of a paced read()
constexpr int most_unanswered = 3;                        // reads in a row, beside the time
constexpr std::int64_t lockstep_wait_ns = 2'000'000'000;  // of every call in a tick
constexpr std::int64_t slice_ns = 20'000'000;             // between two looks at a process outside a tick

template <std::size_t N>
void end_text(char (&text)[N]) noexcept {
  text[N - 1] = '\0';
}

}  // namespace

child_link::~child_link() {
  *last_words_ = what_happened();
  if (process_ == nullptr || process_->is_gone()) return;
  if (trouble_ != trouble::silent) {
    call_request r{.number = ++calls_, .call = static_cast<std::uint32_t>(child_call::quit)};
    page().call.put(r);
    ring(page().host_bell);
  }
  process_->wait_or_kill(trouble_ == trouble::silent ? 0 : options_.farewell_ns);
}

result<void> child_link::start() {
  process_.reset();
  result<std::unique_ptr<child_process>> started = child_process::start(*file_, options_);
  if (!started) return started.error();
  process_ = std::move(started).value();
  trouble_ = trouble::none;
  calls_ = 0;
  request_ = {};
  answer_ = {};
  has_last_ = false;
  stamp_ = silences_ = 0;
  state_ = ASPERITY_STATE_ABSENT;
  unanswered_ = 0;
  list_left_ns_ = options_.list_patience_ns;
  const std::int64_t begin_ns = monotonic_ns();
  if (call(child_call::load, hello_) != ASPERITY_OK) return error{error_code::io_failed, hello_.text};
  list_left_ns_ -= monotonic_ns() - begin_ns;
  return {};
}

std::int64_t child_link::patience_ns(child_call what) const noexcept {
  if (what == child_call::open) return options_.open_patience_ns;
  const bool first = what == child_call::load || what == child_call::list;
  return first ? list_left_ns_ : options_.call_patience_ns;
}

void child_link::fail(call_answer& answer, const std::string& why) const {
  answer.code = ASPERITY_FAILED;
  abi::put_text(answer.text, file_->path().string() + ": " + why);
}

// The first cause stays.
void child_link::give_up(trouble t) noexcept {
  if (trouble_ != trouble::none) return;
  trouble_ = t;
  silent_in_ = process_->phase();
}

std::int32_t child_link::call(child_call what, call_answer& answer, const call_request& with) {
  answer = {};
  if (process_ == nullptr || trouble_ == trouble::gone || trouble_ == trouble::silent) {
    fail(answer, what_happened());
    return ASPERITY_FAILED;
  }
  call_request r = with;
  r.number = ++calls_;
  r.call = static_cast<std::uint32_t>(what);
  page().call.put(r);
  ring(page().host_bell);

  const std::int64_t until_ns = monotonic_ns() + patience_ns(what);
  for (;;) {
    const std::uint32_t bell = page().child_bell.load(std::memory_order_acquire);
    // Asked before the answer is looked for: what it wrote before it ended is there by then.
    const bool gone = process_->is_gone();
    if (page().called.get(answer) && answer.number == r.number) break;
    const bool given_up = what == child_call::open && options_.cancelled && options_.cancelled();
    if (gone) {
      give_up(trouble::gone);
    } else if (given_up || monotonic_ns() >= until_ns) {
      give_up(trouble::silent);
    }
    if (trouble_ == trouble::gone || trouble_ == trouble::silent) {
      answer = {};
      fail(answer, given_up ? "given up while the driver was " + std::string(to_string(silent_in_)) : what_happened());
      process_->kill();
      return ASPERITY_FAILED;
    }
    static_cast<void>(wait_for_change(page().child_bell, bell, slice_ns));
  }
  for (auto* text : {&answer.text, &answer.name, &answer.version, &answer.licence, &answer.vendor}) end_text(*text);
  answer.capabilities.struct_size = sizeof answer.capabilities;
  take_state(answer.stamp, answer.state);
  static_cast<void>(look());
  return answer.code;
}

result<std::vector<listed_item>> child_link::list() {
  call_answer answer{};
  const std::int32_t code = call(child_call::list, answer);
  list_left_ns_ = options_.list_patience_ns;
  if (code != ASPERITY_OK) return error{error_code::io_failed, answer.text};
  if (answer.count > most_listed) {
    return error{error_code::bad_format, file_->path().string() + ": the driver's process lists more than 64 devices"};
  }
  std::vector<listed_item> out(answer.count);
  for (std::size_t i = 0; i < out.size(); ++i) {
    listed_item& item = out[i];
    std::optional<std::string> problem;
    if (!page().listed[i].get(item)) problem = "a device is missing from it";
    item.listing.struct_size = sizeof item.listing;
    item.capabilities.struct_size = sizeof item.capabilities;
    item.listing.capabilities = nullptr;
    if (!problem) problem = find_problem(item.listing);
    if (!problem && item.has_capabilities != 0) problem = find_problem(item.capabilities);
    if (problem) {
      return error{error_code::bad_format, file_->path().string() + ": what the driver lists cannot be: " + *problem};
    }
  }
  return out;
}

std::int32_t child_link::make(const asperity_listing& which, call_answer& answer) {
  which_ = which;
  which_.capabilities = nullptr;
  return call(child_call::make, answer, {.which = which_});
}

std::int32_t child_link::clear_fault(call_answer& answer) {
  if (trouble_ == trouble::gone || trouble_ == trouble::silent) {
    if (const result<void> started = start(); !started) {
      answer = {};
      abi::put_text(answer.text, started.error().message);
      return ASPERITY_FAILED;
    }
    return make(which_, answer);
  }
  if (trouble_ == trouble::program_silent) {
    // The device itself is well: it was disarmed over there, and is given back so that somebody has to open it anew.
    trouble_ = trouble::none;
    return call(child_call::close, answer);
  }
  return call(child_call::clear_fault, answer);
}

void child_link::take_state(std::uint64_t stamp, std::int32_t state) noexcept {
  if (stamp <= stamp_) return;
  stamp_ = stamp;
  state_ = state;
}

void child_link::post() noexcept {
  page().request.put(request_);
  ring(page().host_bell);
}

// What the driver's process has to say, where it changed. Counts that cannot be are no answers.
bool child_link::look() noexcept {
  tick_answer a{};
  if (!page().answer.get(a)) return false;
  if (a.reads > request_.reads || a.writes > request_.writes || a.disarms > request_.disarms) return false;
  if (a.stamp == answer_.stamp) return true;
  if (a.silences != silences_) give_up(trouble::program_silent);
  silences_ = a.silences;
  // A late answer is one too: the driver is slow, and not silent.
  if (a.reads != answer_.reads) {
    unanswered_ = 0;
    if (a.read_code == ASPERITY_OK) {
      last_ = a.sample;
      last_.struct_size = sizeof last_;
      has_last_ = true;
    }
  }
  answer_ = a;
  take_state(a.stamp, a.state);
  return true;
}

// Bounded: so many waits, each so long, whoever rings the bell and how often.
template <class Done>
bool child_link::wait(Done&& done) noexcept {
  const std::int64_t longest_ns = lockstep() ? lockstep_wait_ns / 100 : options_.wait_ns;
  const int waits = lockstep() ? 100 : most_waits;
  for (int i = 0;; ++i) {
    const std::uint32_t bell = page().child_bell.load(std::memory_order_acquire);
    if (look() && done()) return true;
    if (i == waits) return false;
    if (!wait_for_change(page().child_bell, bell, longest_ns)) {
      if (process_->is_gone() || !lockstep()) i = waits - 1;
    }
  }
}

std::int32_t child_link::read(std::int64_t now_ns, asperity_sample& out) noexcept {
  if (trouble_ != trouble::none || process_ == nullptr) return ASPERITY_FAILED;
  request_.read_ns = now_ns;
  ++request_.reads;
  post();
  if (wait([this] { return answer_.reads == request_.reads; })) {
    if (trouble_ != trouble::none) return ASPERITY_FAILED;
    if (answer_.read_code == ASPERITY_OK) abi::copy_out(last_, out);
    return answer_.read_code;
  }
  if (unanswered_++ == 0) unanswered_ns_ = now_ns;
  if (process_->is_gone()) {
    give_up(trouble::gone);
  } else if (lockstep() || (unanswered_ >= most_unanswered && now_ns - unanswered_ns_ > options_.silence_ns)) {
    give_up(trouble::silent);
  }
  if (trouble_ != trouble::none || !has_last_) return ASPERITY_FAILED;
  abi::copy_out(last_, out);
  return ASPERITY_OK;
}

std::int32_t child_link::write(std::int64_t now_ns, const asperity_command& command) noexcept {
  if (trouble_ != trouble::none || process_ == nullptr) return ASPERITY_FAILED;
  request_.write_ns = now_ns;
  request_.command = command;
  ++request_.writes;
  post();
  if (lockstep() && !wait([this] { return answer_.writes == request_.writes; })) {
    give_up(process_->is_gone() ? trouble::gone : trouble::silent);
    return ASPERITY_FAILED;
  }
  // Paced: what came of the command before; of this one the next tick tells.
  return answer_.write_code;
}

std::int32_t child_link::disarm() noexcept {
  if (process_ == nullptr || trouble_ == trouble::gone) return ASPERITY_FAILED;
  ++request_.disarms;
  request_.command = abi::to_abi(device_command{.frame = wrench_frame::device_base});
  post();
  if (trouble_ == trouble::silent) return ASPERITY_FAILED;  // it finds zero and disarm where it comes back
  if (wait([this] { return answer_.disarms == request_.disarms; })) return answer_.disarm_code;
  if (process_->is_gone()) give_up(trouble::gone);
  return ASPERITY_FAILED;  // on its way, and nobody has said yet that it is done
}

std::int32_t child_link::state() const noexcept {
  if (process_ == nullptr) return ASPERITY_STATE_ABSENT;
  if (trouble_ != trouble::none) return ASPERITY_STATE_FAULT;
  // A disarm() that is on its way counts as done: the device is not asked for anything else until it is.
  const bool on_its_way = answer_.disarms != request_.disarms;
  const bool up = state_ == ASPERITY_STATE_ARMED || state_ == ASPERITY_STATE_ACTIVE;
  return on_its_way && up ? ASPERITY_STATE_READY : state_;
}

std::string child_link::what_happened() const {
  switch (trouble_) {
    case trouble::none:
      return unanswered_ < most_unanswered || process_ == nullptr
                 ? std::string()
                 : "the driver's process had not answered the last " + std::to_string(unanswered_) + " reads: it was " +
                       to_string(process_->phase());
    case trouble::gone:
      return process_->end_text();
    case trouble::silent:
      return std::string("the driver did not come back: it was ") + to_string(silent_in_);
    case trouble::program_silent:
      return "this program was silent for too long: the driver's process put out zero and disarmed the device";
  }
  return {};
}

}  // namespace asperity::plugin
