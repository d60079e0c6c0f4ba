// A recording for ROS 2's tools, PlotJuggler, Foxglove and rerun: MCAP, profile ros2, messages in CDR.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/version.hpp"
#include "file_numbers.hpp"
#include "mcap_schemas.hpp"
#include "recording.hpp"
#include "row_encoder.hpp"

namespace asperity::command {
namespace {

// A chunk is closed when its messages take so many bytes: a tenth of a second at 1 kHz.
constexpr std::size_t chunk_size = std::size_t{1} << 16;

enum class op : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  statistics = 11,
  summary_offset = 14,
  data_end = 15,
};

constexpr std::string_view magic("\x89MCAP0\r\n", 8);

void put_text(std::string& out, std::string_view text) {
  put_number(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

void put_record(std::string& out, op kind, std::string_view content) {
  put_number(out, static_cast<std::uint8_t>(kind));
  put_number(out, static_cast<std::uint64_t>(content.size()));
  out += content;
}

/// A message in OMG's common data representation, little-endian: each number lies at a multiple of its own size, counted
/// from behind the four bytes that say so.
class cdr_writer {
 public:
  explicit cdr_writer(std::string& out) : out_(out) {
    out_ += std::string_view("\x00\x01\x00\x00", 4);
    origin_ = out_.size();
  }
  void header(std::int64_t time_ns, std::string_view frame) {
    constexpr std::int64_t second_ns = 1'000'000'000;
    number(static_cast<std::int32_t>(time_ns / second_ns));
    number(static_cast<std::uint32_t>(time_ns % second_ns));
    text(frame);
  }
  template <class Number>
  void number(Number value) {
    while ((out_.size() - origin_) % sizeof value != 0) out_ += '\0';
    put_number(out_, value);
  }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    out_ += value;
    out_ += '\0';
  }
  void numbers(std::span<const double> values) {
    for (const double x : values) number(x);
  }

 private:
  std::string& out_;
  std::size_t origin_ = 0;
};

struct topic {
  const char* name;
  const char* type;
  std::uint16_t schema;
};

constexpr std::array<topic, 5> topics{{{"/asperity/device/pose", "geometry_msgs/msg/PoseStamped", 1},
                                       {"/asperity/probe/pose", "geometry_msgs/msg/PoseStamped", 1},
                                       {"/asperity/contact/wrench", "geometry_msgs/msg/WrenchStamped", 2},
                                       {"/asperity/hand/wrench", "geometry_msgs/msg/WrenchStamped", 2},
                                       {"/asperity/tick", "asperity_msgs/msg/Tick", 3}}};

std::string schema_content(std::uint16_t id, std::string_view name, std::string_view definition) {
  std::string out;
  put_number(out, id);
  put_text(out, name);
  put_text(out, "ros2msg");
  put_text(out, definition);
  return out;
}

std::string channel_content(std::uint16_t id, const topic& of) {
  std::string pairs, out;
  put_text(pairs, "offered_qos_profiles");
  put_text(pairs, "");
  put_number(out, id);
  put_number(out, of.schema);
  put_text(out, of.name);
  put_text(out, "cdr");
  put_text(out, pairs);
  return out;
}

/// Where a chunk lies and what it holds.
struct chunk_place {
  std::uint64_t first_ns = 0, last_ns = 0, offset = 0, length = 0, index_length = 0, size = 0;
  std::array<std::uint64_t, topics.size()> index_offset{};
};

class mcap_encoder final : public row_encoder {
 public:
  void begin(std::string& out) override {
    std::string text, content;
    put_text(content, "ros2");
    put_text(content, "asperity " ASPERITY_VERSION_STRING);
    text += magic;
    put_record(text, op::header, content);
    put_schemas(text);
    put_channels(text);
    emit(out, text);
  }

  result<void> add(std::string& out, const session_record& tick) override {
    const std::array<double, recorded_numbers> n = numbers_of(tick);
    const std::span<const double> all(n);
    const std::int64_t t = tick.time_ns;
    put_message(0, t, "device", all.subspan(1, 7));
    put_message(1, t, "world", all.subspan(8, 7));
    put_message(2, t, "world", all.subspan(15, 6));
    put_message(3, t, "device", all.subspan(21, 6));
    std::string& data = begin_message(4, t);
    cdr_writer cdr(data);
    cdr.header(t, "world");
    cdr.numbers(all.subspan(27));
    for (const char* const word : words_of(tick)) cdr.text(word);
    end_message(4, t);
    if (rows_ == 0) first_ns_ = t;
    last_ns_ = t;
    ++rows_;
    ++sequence_;
    if (messages_.size() >= chunk_size) put_chunk(out);
    return {};
  }

  bool end(std::string& out) override {
    put_chunk(out);
    std::string text, content;
    put_number(content, crc_);
    put_record(text, op::data_end, content);
    emit(out, text);
    put_summary(out);
    return false;
  }

  // As rosbag2 writes it, of its version 5.
  companion beside(const std::filesystem::path& file) const override {
    const std::string name = file.filename().string();
    const std::string length = std::to_string(last_ns_ - first_ns_), start = std::to_string(first_ns_);
    const std::string count = std::to_string(rows_), all = std::to_string(rows_ * topics.size());
    std::string out =
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  duration:\n    nanoseconds: " +
        length + "\n  starting_time:\n    nanoseconds_since_epoch: " + start + "\n  message_count: " + all +
        "\n  topics_with_message_count:\n";
    for (const topic& t : topics) {
      out += "    - topic_metadata:\n        name: " + std::string(t.name) + "\n        type: " + t.type +
             "\n        serialization_format: cdr\n        offered_qos_profiles: \"\"\n      message_count: " + count +
             "\n";
    }
    std::string quoted;
    for (const char c : name) quoted += c == '\'' ? "''" : std::string(1, c);
    quoted = "'" + quoted + "'";
    out += "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - " + quoted +
           "\n  files:\n    - path: " + quoted + "\n      starting_time:\n        nanoseconds_since_epoch: " + start +
           "\n      duration:\n        nanoseconds: " + length + "\n      message_count: " + all + "\n";
    return {"metadata.yaml", out};
  }

 private:
  // Everything that goes into the file passes here.
  void emit(std::string& out, std::string_view bytes) {
    crc_ = crc32(bytes, crc_);
    written_ += bytes.size();
    out += bytes;
  }

  static void put_schemas(std::string& out) {
    put_record(out, op::schema, schema_content(1, "geometry_msgs/msg/PoseStamped", pose_definition()));
    put_record(out, op::schema, schema_content(2, "geometry_msgs/msg/WrenchStamped", wrench_definition()));
    put_record(out, op::schema, schema_content(3, "asperity_msgs/msg/Tick", tick_definition()));
  }
  static void put_channels(std::string& out) {
    for (std::size_t i = 0; i < topics.size(); ++i)
      put_record(out, op::channel, channel_content(static_cast<std::uint16_t>(i + 1), topics[i]));
  }

  void put_message(std::size_t channel, std::int64_t time_ns, std::string_view frame, std::span<const double> values) {
    cdr_writer cdr(begin_message(channel, time_ns));
    cdr.header(time_ns, frame);
    cdr.numbers(values);
    end_message(channel, time_ns);
  }
  std::string& begin_message(std::size_t channel, std::int64_t time_ns) {
    content_.clear();
    put_number(content_, static_cast<std::uint16_t>(channel + 1));
    put_number(content_, sequence_);
    put_number(content_, static_cast<std::uint64_t>(time_ns));  // logged ...
    put_number(content_, static_cast<std::uint64_t>(time_ns));  // ... and published
    message_.clear();
    return message_;
  }
  void end_message(std::size_t channel, std::int64_t time_ns) {
    const auto logged = static_cast<std::uint64_t>(time_ns);
    if (messages_.empty()) chunk_.first_ns = logged;
    chunk_.last_ns = logged;
    put_number(index_[channel], logged);
    put_number(index_[channel], static_cast<std::uint64_t>(messages_.size()));
    put_record(messages_, op::message, content_ + message_);
  }

  void put_chunk(std::string& out) {
    if (messages_.empty()) return;
    std::string content, text;
    put_number(content, chunk_.first_ns);
    put_number(content, chunk_.last_ns);
    put_number(content, static_cast<std::uint64_t>(messages_.size()));
    put_number(content, crc32(messages_));
    put_text(content, "");  // not compressed
    put_number(content, static_cast<std::uint64_t>(messages_.size()));
    content += messages_;
    put_record(text, op::chunk, content);
    chunk_.offset = written_;
    chunk_.length = text.size();
    chunk_.size = messages_.size();
    for (std::size_t i = 0; i < topics.size(); ++i) {
      chunk_.index_offset[i] = written_ + text.size();
      content.clear();
      put_number(content, static_cast<std::uint16_t>(i + 1));
      put_text(content, index_[i]);
      put_record(text, op::message_index, content);
      index_[i].clear();
    }
    chunk_.index_length = text.size() - chunk_.length;
    emit(out, text);
    chunks_.push_back(chunk_);
    messages_.clear();
  }

  void put_chunk_indexes(std::string& out) const {
    std::string content, offsets;
    for (const chunk_place& c : chunks_) {
      content.clear();
      offsets.clear();
      for (std::size_t i = 0; i < topics.size(); ++i) {
        put_number(offsets, static_cast<std::uint16_t>(i + 1));
        put_number(offsets, c.index_offset[i]);
      }
      put_number(content, c.first_ns);
      put_number(content, c.last_ns);
      put_number(content, c.offset);
      put_number(content, c.length);
      put_text(content, offsets);
      put_number(content, c.index_length);
      put_text(content, "");
      put_number(content, c.size);
      put_number(content, c.size);
      put_record(out, op::chunk_index, content);
    }
  }

  void put_statistics(std::string& out) const {
    std::string content, counts;
    put_number(content, rows_ * topics.size());
    put_number(content, std::uint16_t{3});
    put_number(content, static_cast<std::uint32_t>(topics.size()));
    put_number(content, std::uint32_t{0});  // attachments
    put_number(content, std::uint32_t{0});  // metadata
    put_number(content, static_cast<std::uint32_t>(chunks_.size()));
    put_number(content, static_cast<std::uint64_t>(first_ns_));
    put_number(content, static_cast<std::uint64_t>(last_ns_));
    for (std::size_t i = 0; i < topics.size(); ++i) {
      put_number(counts, static_cast<std::uint16_t>(i + 1));
      put_number(counts, rows_);
    }
    put_text(content, counts);
    put_record(out, op::statistics, content);
  }

  void put_summary(std::string& out) {
    const std::uint64_t start = written_;
    std::string summary, offsets, content;
    const auto group = [&](op kind, const auto& put) {
      const std::size_t at = summary.size();
      put(summary);
      if (summary.size() == at) return;
      content.clear();
      put_number(content, static_cast<std::uint8_t>(kind));
      put_number(content, start + at);
      put_number(content, static_cast<std::uint64_t>(summary.size() - at));
      put_record(offsets, op::summary_offset, content);
    };
    group(op::schema, [](std::string& to) { put_schemas(to); });
    group(op::channel, [](std::string& to) { put_channels(to); });
    group(op::statistics, [this](std::string& to) { put_statistics(to); });
    group(op::chunk_index, [this](std::string& to) { put_chunk_indexes(to); });
    const std::uint64_t offset_start = start + summary.size();
    summary += offsets;
    // The footer's own beginning is part of what its checksum is of.
    std::string footer;
    constexpr std::uint64_t footer_size = 20;
    put_number(footer, static_cast<std::uint8_t>(op::footer));
    put_number(footer, footer_size);
    put_number(footer, start);
    put_number(footer, offset_start);
    summary += footer;
    put_number(summary, crc32(summary));
    summary += magic;
    emit(out, summary);
  }

  std::uint64_t written_ = 0, rows_ = 0;
  std::uint32_t crc_ = 0, sequence_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
  std::string messages_, content_, message_;
  std::array<std::string, topics.size()> index_;
  chunk_place chunk_;
  std::vector<chunk_place> chunks_;
};

}  // namespace

std::unique_ptr<row_encoder> make_mcap_encoder() { return std::make_unique<mcap_encoder>(); }

}  // namespace asperity::command
