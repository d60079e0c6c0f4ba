#include "recording.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <utility>

#include "text.hpp"

namespace asperity::command {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 16;

std::string make_header() {
  std::string header;
  for (const std::string& name : recording_columns()) header += (header.empty() ? "" : ",") + name;
  return header + '\n';
}

class csv_encoder final : public row_encoder {
 public:
  void begin(std::string& out) override { out += recording_header(); }
  result<void> add(std::string& out, const session_record& tick) override {
    append_row(out, tick);
    return {};
  }
  bool end(std::string&) override { return false; }
};

// What a file beside the recording says belongs to it; another recording's description stays.
result<void> check_companion(const std::filesystem::path& file, const std::string& name) {
  const std::filesystem::path beside = file.parent_path() / name;
  std::error_code ignored;
  if (!std::filesystem::exists(beside, ignored)) return {};
  std::ifstream in(beside, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.find("'" + file.filename().string() + "'") != std::string::npos) return {};
  return error{error_code::invalid_argument, beside.string() + " is there already and is of another recording than " +
                                                 file.filename().string() +
                                                 ": give each .mcap a folder of its own, as a bag of ROS 2 has"};
}

}  // namespace

const std::string& recording_header() {
  static const std::string header = make_header();
  return header;
}

void append_row(std::string& out, const session_record& tick) {
  bool first = true;
  for (const double x : numbers_of(tick)) {
    if (!first) out += ',';
    first = false;
    append_number(out, x);
  }
  for (const char* const word : words_of(tick)) {
    out += ',';
    out += word;
  }
  out += '\n';
}

std::unique_ptr<row_encoder> make_csv_encoder() { return std::make_unique<csv_encoder>(); }

std::unique_ptr<row_encoder> encoder_for(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".npz") return make_npz_encoder();
  return extension == ".mcap" ? make_mcap_encoder() : make_csv_encoder();
}

result<recording> recording::create(const std::filesystem::path& file) {
  std::unique_ptr<row_encoder> encoder = encoder_for(file);
  if (const row_encoder::companion beside = encoder->beside(file); !beside.name.empty()) {
    if (const result<void> ok = check_companion(file, beside.name); !ok) return ok.error();
  }
  result<output_file> opened = output_file::create(file);
  if (!opened) return opened.error();
  recording made(std::move(opened).value(), file, std::move(encoder));
  made.encoder_->begin(made.pending_);
  // Written at once: a full disk is found before the session and not after it.
  if (const result<void> written = made.flush(); !written) return written.error();
  return made;
}

result<void> recording::add(const session_record& tick) {
  if (const result<void> fits = encoder_->add(pending_, tick); !fits) return fits;
  return pending_.size() < block_size ? result<void>() : flush();
}

result<void> recording::close() {
  closing_ = true;
  if (encoder_->starts_anew()) {
    pending_.clear();
    if (const result<void> emptied = file_.start_anew(); !emptied) return emptied;
  }
  for (bool more = true; more;) {
    more = encoder_->end(pending_);
    if (const result<void> written = flush(); !written) return written;
  }
  const row_encoder::companion beside = file_.is_replaceable() ? encoder_->beside(name_) : row_encoder::companion{};
  if (beside.name.empty()) return file_.commit();
  result<output_file> description = output_file::create(name_.parent_path() / beside.name);
  if (!description) return description.error();
  if (const result<void> written = description->write(beside.text); !written) return written;
  if (const result<void> done = file_.commit(); !done) return done;
  return description->commit();
}

result<void> recording::flush() {
  // What only stands in for a file is nothing for a pipe.
  if (encoder_->starts_anew() && !file_.is_replaceable() && !closing_) {
    pending_.clear();
    return {};
  }
  const result<void> written = file_.write(pending_);
  pending_.clear();
  return written;
}

}  // namespace asperity::command
