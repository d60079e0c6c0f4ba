#include "child_server.hpp"

#include <algorithm>
#include <unistd.h>
#include <utility>

#include "asperity/device/driver_conversion.hpp"
#include "asperity/plugin/futex.hpp"

namespace asperity::plugin {
namespace {

constexpr std::int64_t longest_hold_ns = 100'000'000;  // whatever a command says about itself
constexpr std::int64_t watch_ns = 2'000'000;           // between two looks while the device may put out
constexpr std::int64_t idle_ns = 50'000'000;           // otherwise

device_listing from_abi(const asperity_listing& l) {
  const auto text = [](std::span<const char> field) { return std::string(abi::get_text(field).value_or("")); };
  return {.driver = {},
          .identity = text(l.identity),
          .path = text(l.path),
          .name = text(l.name),
          .maturity = static_cast<driver_maturity>(std::min(l.maturity, ASPERITY_MATURITY_HARDWARE_VERIFIED))};
}

listed_item to_item(const device_listing& d) {
  listed_item item{abi::blank<asperity_listing>(), abi::to_abi(d.capabilities), 0};
  item.listing.maturity = static_cast<std::uint32_t>(d.maturity);
  abi::put_text(item.listing.identity, d.identity);
  abi::put_text(item.listing.path, d.path);
  abi::put_text(item.listing.name, d.name);
  if (d.not_openable) abi::put_text(item.listing.not_openable, *d.not_openable);
  item.has_capabilities = d.capabilities.name.empty() ? 0 : 1;
  return item;
}

}  // namespace

// Says what the process is about, for as long as it lives.
class child_server::in_phase {
 public:
  in_phase(child_page& page, child_phase p) noexcept : page_(page) { set(p); }
  in_phase(const in_phase&) = delete;
  in_phase& operator=(const in_phase&) = delete;
  ~in_phase() { set(child_phase::idle); }

 private:
  void set(child_phase p) noexcept { page_.phase.store(static_cast<std::uint32_t>(p), std::memory_order_relaxed); }
  child_page& page_;
};

int child_server::serve() {
  while (!quit_) {
    const std::uint32_t bell = page_.host_bell.load(std::memory_order_acquire);
    bool worked = answer_ticks();
    worked = answer_call() || worked;
    if (is_program_gone()) break;
    if (worked) continue;
    watch();
    const bool up = device_ && may_put_out(device_->state());
    static_cast<void>(wait_for_change(page_.host_bell, bell, up ? watch_ns : idle_ns));
  }
  page_.phase.store(static_cast<std::uint32_t>(child_phase::ending), std::memory_order_relaxed);
  if (device_) {
    silence();
    device_->close();
  }
  device_.reset();
  driver_.reset();
  return 0;
}

// A thread of the program that ends is no end of the program, though the kernel's signal comes for it as well.
bool child_server::is_program_gone() const noexcept { return ::getppid() != program_; }

std::int32_t child_server::state() const noexcept {
  return device_ ? static_cast<std::int32_t>(device_->state()) : ASPERITY_STATE_ABSENT;
}

void child_server::publish() noexcept {
  ticks_.stamp = ++stamp_;
  ticks_.state = state();
  page_.answer.put(ticks_);
  ring(page_.child_bell);
}

// Newest of each kind: disarm before everything, then the command, then a measurement.
bool child_server::answer_ticks() {
  tick_request r{};
  if (!page_.request.get(r)) return false;
  const bool disarms = r.disarms != ticks_.disarms;
  const bool writes = r.writes != ticks_.writes;
  const bool reads = r.reads != ticks_.reads;
  if (!disarms && !writes && !reads) return false;
  heard_ns_ = monotonic_ns();
  if (disarms) {
    const in_phase now(page_, child_phase::disarm);
    ticks_.disarm_code = device_ ? abi::to_code(device_->disarm()) : ASPERITY_NOT_READY;
    ticks_.disarms = r.disarms;
  }
  if (writes) {
    const in_phase now(page_, child_phase::write);
    r.command.struct_size = sizeof r.command;
    commanded_ = true;
    session_ns_ = r.write_ns;
    const bool ordinary = r.command.valid_until_ns > r.write_ns;
    hold_ns_ = ordinary ? std::min<std::int64_t>(longest_hold_ns, r.command.valid_until_ns - r.write_ns) : 0;
    ticks_.write_code =
        device_ ? abi::to_code(device_->write(r.write_ns, abi::from_abi(r.command))) : ASPERITY_NOT_READY;
    ticks_.writes = r.writes;
  }
  if (reads) {
    const in_phase now(page_, child_phase::read);
    session_ns_ = r.read_ns;
    device_sample in = abi::from_abi(sample_);
    ticks_.read_code = device_ ? abi::to_code(device_->read(r.read_ns, in)) : ASPERITY_NOT_READY;
    if (ticks_.read_code == ASPERITY_OK) sample_ = abi::to_abi(in);
    ticks_.sample = sample_;
    ticks_.reads = r.reads;
  }
  publish();
  return true;
}

bool child_server::answer_call() {
  call_request r{};
  if (!page_.call.get(r) || r.number == call_) return false;
  call_ = r.number;
  call_answer a{};
  a.number = r.number;
  if (r.call < child_call_count) answer(r, a);
  a.stamp = ++stamp_;
  a.state = state();
  page_.called.put(a);
  ring(page_.child_bell);
  heard_ns_ = monotonic_ns();
  return true;
}

void child_server::finish(call_answer& a, const result<void>& done) noexcept {
  a.code = done ? ASPERITY_OK : ASPERITY_FAILED;
  if (!done) abi::put_text(a.text, done.error().message);
}

void child_server::answer(const call_request& r, call_answer& a) {
  const auto what = static_cast<child_call>(r.call);
  if (what == child_call::quit) {
    quit_ = true;
    a.code = ASPERITY_OK;
    return;
  }
  if (what == child_call::load) return load(a);
  if (driver_ == nullptr) return abi::put_text(a.text, "the driver was not loaded");
  if (what == child_call::list) return list(a);
  if (what == child_call::make) return make(r, a);
  if (!device_) return abi::put_text(a.text, "no device was made");
  switch (what) {
    case child_call::destroy: {
      const in_phase now(page_, child_phase::destroy);
      device_.reset();
      a.code = ASPERITY_OK;
      break;
    }
    case child_call::capabilities:
      a.capabilities = abi::to_abi(device_->capabilities());
      a.code = ASPERITY_OK;
      break;
    case child_call::open: {
      const in_phase now(page_, child_phase::open);
      finish(a, device_->open());
      break;
    }
    case child_call::arm: {
      const in_phase now(page_, child_phase::arm);
      commanded_ = false;
      finish(a, device_->arm());
      break;
    }
    case child_call::clear_fault: {
      const in_phase now(page_, child_phase::clear_fault);
      finish(a, device_->clear_fault());
      break;
    }
    case child_call::close: {
      const in_phase now(page_, child_phase::close);
      device_->close();
      a.code = ASPERITY_OK;
      break;
    }
    case child_call::fault_text: {
      const in_phase now(page_, child_phase::fault_text);
      abi::put_text(a.text, device_->fault_text());
      a.code = ASPERITY_OK;
      break;
    }
    default:
      abi::put_text(a.text, "this version does not know the call");
      break;
  }
}

void child_server::load(call_answer& a) {
  const in_phase now(page_, child_phase::loading);
  if (!file_) return abi::put_text(a.text, "the driver was loaded already");
  load_failure failure{};
  std::shared_ptr<const driver_module> module = driver_module::load(std::move(*file_), {}, failure);
  file_.reset();
  if (module == nullptr) return abi::put_text(a.text, failure.why.message);
  const asperity_driver& t = module->table();
  a.maturity = t.maturity;
  abi::put_text(a.name, t.name);
  abi::put_text(a.version, t.version);
  abi::put_text(a.licence, t.licence);
  abi::put_text(a.vendor, t.vendor);
  driver_ = std::make_unique<plugin_driver>(std::move(module));
  a.code = ASPERITY_OK;
}

void child_server::list(call_answer& a) {
  const in_phase now(page_, child_phase::list);
  const result<std::vector<device_listing>> found = driver_->list();
  if (!found) return abi::put_text(a.text, found.error().message);
  a.count = static_cast<std::uint32_t>(std::min(found->size(), most_listed));
  for (std::size_t i = 0; i < a.count; ++i) page_.listed[i].put(to_item((*found)[i]));
  a.code = ASPERITY_OK;
}

void child_server::make(const call_request& r, call_answer& a) {
  const in_phase now(page_, child_phase::make);
  if (const std::optional<std::string> problem = find_problem(r.which)) return abi::put_text(a.text, *problem);
  if (device_) return abi::put_text(a.text, "a device was made already");
  result<plugin_device> made = driver_->make_plugin(from_abi(r.which));
  if (!made) return abi::put_text(a.text, made.error().message);
  device_.emplace(std::move(made).value());
  a.code = ASPERITY_OK;
}

void child_server::silence() noexcept {
  const std::int64_t now_ns = session_ns_ + (monotonic_ns() - heard_ns_);
  {
    const in_phase now(page_, child_phase::write);
    static_cast<void>(device_->write(now_ns, {.frame = wrench_frame::device_base, .valid_until_ns = now_ns}));
  }
  const in_phase now(page_, child_phase::disarm);
  static_cast<void>(device_->disarm());
}

void child_server::watch() {
  if (page_.paced == 0 || !commanded_ || !device_ || !may_put_out(device_->state())) return;
  const std::int64_t silent_ns = monotonic_ns() - heard_ns_;
  if (silent_ns <= hold_ns_) return;
  if (silent_ns > hold_ns_ + page_.disarm_after_ns) {
    silence();
    ++ticks_.silences;
    publish();
    return;
  }
  const in_phase now(page_, child_phase::write);
  const std::int64_t now_ns = session_ns_ + silent_ns;
  static_cast<void>(device_->write(now_ns, {.frame = wrench_frame::device_base, .valid_until_ns = now_ns + watch_ns}));
}

}  // namespace asperity::plugin
