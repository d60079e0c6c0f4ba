// A recording for numpy.load: a ZIP archive that stores one .npy per column.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "file_numbers.hpp"
#include "recording.hpp"
#include "row_encoder.hpp"

namespace asperity::command {
namespace {

/// Rows of the longest recording, as of a device recording; 32-bit offsets hold it.
constexpr std::size_t most_rows = 4'000'000;
constexpr std::size_t word_length = 32;  // characters of a word, as the Python package has them

/// A stored entry of the archive.
struct entry {
  std::string name;
  std::uint32_t crc = 0, size = 0, offset = 0;
};

// .npy, version 1.0: its header ends at a multiple of 64 bytes.
std::string npy_header(std::string_view type, std::size_t rows) {
  std::string dictionary =
      "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ",), }";
  constexpr std::size_t before = 10, multiple = 64;
  while ((before + dictionary.size() + 1) % multiple != 0) dictionary += ' ';
  dictionary += '\n';
  std::string out = "\x93NUMPY";
  out += '\x01';
  out += '\x00';
  put_number(out, static_cast<std::uint16_t>(dictionary.size()));
  return out + dictionary;
}

void put_fields(std::string& out, const entry& e) {
  constexpr std::uint16_t version = 20, stored = 0, no_flags = 0, midnight = 0, first_of_1980 = 0x21;
  put_number(out, version);
  put_number(out, no_flags);
  put_number(out, stored);
  put_number(out, midnight);
  put_number(out, first_of_1980);
  put_number(out, e.crc);
  put_number(out, e.size);
  put_number(out, e.size);
  put_number(out, static_cast<std::uint16_t>(e.name.size()));
  put_number(out, std::uint16_t{0});  // no extra field
}

class npz_encoder final : public row_encoder {
 public:
  npz_encoder() : names_(recording_columns()) {}

  // Columns can be written only when all rows are there. Until then the rows stand in the file as comma-separated
  // values, so that a kill loses no more of this recording than of one that ends in .csv.
  void begin(std::string& out) override { out += recording_header(); }

  result<void> add(std::string& out, const session_record& tick) override {
    if (words_.size() == most_rows) {
      return error{error_code::limit_exceeded, "a recording for numpy holds " + std::to_string(most_rows) +
                                                   " rows at the most: record a .csv or a .mcap, or a shorter session"};
    }
    append_row(out, tick);
    const auto numbers = numbers_of(tick);
    numbers_.insert(numbers_.end(), numbers.begin(), numbers.end());
    words_.push_back(words_of(tick));
    return {};
  }

  bool starts_anew() const noexcept override { return true; }

  // A column at a time, so that no more than one stands in memory twice.
  bool end(std::string& out) override {
    const std::size_t before = out.size();
    const std::size_t i = entries_.size();
    if (i == names_.size()) {
      put_directory(out, entries_, at_);
      return false;
    }
    std::string column;
    if (i < recorded_numbers) {
      put_number_column(column, i);
    } else {
      put_word_column(column, i - recorded_numbers);
    }
    entry e{names_[i] + ".npy", crc32(column), static_cast<std::uint32_t>(column.size()),
            static_cast<std::uint32_t>(at_)};
    out += std::string_view("PK\x03\x04", 4);
    put_fields(out, e);
    out += e.name;
    out += column;
    entries_.push_back(std::move(e));
    at_ += out.size() - before;
    return true;
  }

 private:
  void put_number_column(std::string& out, std::size_t i) const {
    out += npy_header("<f8", words_.size());
    for (std::size_t row = 0; row < words_.size(); ++row) put_number(out, numbers_[row * recorded_numbers + i]);
  }

  // UTF-32, filled up with zeros. The words are ASCII.
  void put_word_column(std::string& out, std::size_t i) const {
    out += npy_header("<U" + std::to_string(word_length), words_.size());
    for (const auto& words : words_) {
      const std::string_view word = std::string_view(words[i]).substr(0, word_length);
      for (const char c : word) put_number(out, static_cast<std::uint32_t>(static_cast<unsigned char>(c)));
      out.append((word_length - word.size()) * sizeof(std::uint32_t), '\0');
    }
  }

  static void put_directory(std::string& out, const std::vector<entry>& entries, std::size_t at) {
    const std::size_t begin = out.size();
    for (const entry& e : entries) {
      out += std::string_view("PK\x01\x02", 4);
      constexpr std::uint16_t made_by = 20;
      put_number(out, made_by);
      put_fields(out, e);
      put_number(out, std::uint16_t{0});  // no comment
      put_number(out, std::uint16_t{0});  // first disk
      put_number(out, std::uint16_t{0});  // no attributes
      put_number(out, std::uint32_t{0});
      put_number(out, e.offset);
      out += e.name;
    }
    const auto count = static_cast<std::uint16_t>(entries.size());
    const std::size_t size = out.size() - begin;
    out += std::string_view("PK\x05\x06", 4);
    put_number(out, std::uint32_t{0});  // one disk
    put_number(out, count);
    put_number(out, count);
    put_number(out, static_cast<std::uint32_t>(size));
    put_number(out, static_cast<std::uint32_t>(at));
    put_number(out, std::uint16_t{0});  // no comment
  }

  std::vector<std::string> names_;
  std::vector<double> numbers_;  // row by row
  std::vector<std::array<const char*, recorded_words>> words_;
  std::vector<entry> entries_;  // that are written
  std::size_t at_ = 0;          // bytes of them
};

}  // namespace

std::unique_ptr<row_encoder> make_npz_encoder() { return std::make_unique<npz_encoder>(); }

}  // namespace asperity::command
