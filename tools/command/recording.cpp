#include "recording.hpp"

#include <utility>

#include "text.hpp"

namespace asperity::command {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 16;

class line_writer {
 public:
  explicit line_writer(std::string& out) : out_(out) {}
  line_writer& operator<<(double x) {
    if (!first_) out_ += ',';
    first_ = false;
    append_number(out_, x);
    return *this;
  }
  line_writer& operator<<(const vec3& v) { return *this << v.x << v.y << v.z; }
  line_writer& operator<<(const pose& T) {
    *this << T.position;
    for (const double q : to_xyzw(T.rotation)) *this << q;
    return *this;
  }
  line_writer& operator<<(const wrench& w) { return *this << w.force << w.torque; }

 private:
  std::string& out_;
  bool first_ = true;
};

std::string make_header() {
  std::string header = "time_s";
  for (const std::string who : {"device", "probe"}) {
    for (const char* axis : {"_x_m", "_y_m", "_z_m", "_qx", "_qy", "_qz", "_qw"}) header += ',' + who + axis;
  }
  for (const std::string who : {"contact", "hand"}) {
    for (const char* axis : {"_fx_n", "_fy_n", "_fz_n", "_tx_n_m", "_ty_n_m", "_tz_n_m"}) header += ',' + who + axis;
  }
  return header +
         ",depth_m,contacts,contact_age_s,delivered_j,surplus_j,guard_alpha_per_s,guard_scale,sample,device,fault\n";
}

}  // namespace

const std::string& recording_header() {
  static const std::string header = make_header();
  return header;
}

void append_row(std::string& out, const session_record& tick) {
  line_writer line(out);
  line << static_cast<double>(tick.time_ns) / 1e9 << tick.T_dh << tick.T_wa << tick.on_probe_w << tick.on_hand_d
       << tick.max_depth_m << static_cast<double>(tick.contacts) << static_cast<double>(tick.contact_age_ns) / 1e9
       << tick.delivered_j << tick.surplus_j << tick.guard_alpha_per_s << tick.guard_scale;
  out += ',';
  out += to_string(tick.sample);
  out += ',';
  out += to_string(tick.device);
  out += ',';
  out += to_string(tick.fault);
  out += '\n';
}

result<recording> recording::create(const std::filesystem::path& file) {
  result<output_file> opened = output_file::create(file);
  if (!opened) return opened.error();
  recording made(std::move(opened).value());
  made.pending_ = recording_header();
  // Written at once: a full disk is found before the session and not after it.
  if (const result<void> written = made.flush(); !written) return written.error();
  return made;
}

result<void> recording::add(const session_record& tick) {
  append_row(pending_, tick);
  return pending_.size() < block_size ? result<void>() : flush();
}

result<void> recording::close() {
  if (const result<void> written = flush(); !written) return written.error();
  return file_.commit();
}

result<void> recording::flush() {
  const result<void> written = file_.write(pending_);
  pending_.clear();
  return written;
}

}  // namespace asperity::command
