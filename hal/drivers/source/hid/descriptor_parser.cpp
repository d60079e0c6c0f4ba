#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/drivers/hid/report_descriptor.hpp"

namespace asperity {
namespace {

// State of one run over a descriptor.
class descriptor_parser {
 public:
  descriptor_parser(std::span<const std::uint8_t> bytes, report_descriptor& out) noexcept : bytes_(bytes), out_(&out) {}

  [[nodiscard]] descriptor_status run() noexcept {
    if (bytes_.empty()) return descriptor_status::empty;
    if (bytes_.size() > report_descriptor::max_bytes) return descriptor_status::too_large;
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const std::uint8_t head = bytes_[at];
      if (head == long_item) {  // nothing is defined for long items: they are passed over
        if (at + 2 >= bytes_.size()) return descriptor_status::cut_off;
        const std::size_t length = 3U + bytes_[at + 1];
        if (length > bytes_.size() - at) return descriptor_status::cut_off;
        at += length;
        continue;
      }
      const std::size_t size = (head & 3U) == 3U ? 4U : (head & 3U);
      if (bytes_.size() - at - 1 < size) return descriptor_status::cut_off;
      item it{static_cast<std::uint8_t>(head >> 2), size, 0, 0};
      for (std::size_t i = 0; i < size; ++i) it.raw |= static_cast<std::uint32_t>(bytes_[at + 1 + i]) << (8 * i);
      it.with_sign = extend(it.raw, size);
      at += 1 + size;
      const descriptor_status s = take(it);
      if (s != descriptor_status::ok) return s;
    }
    if (depth_ != 0 || pushed_ != 0) return descriptor_status::unbalanced;
    return out_->fields.dropped() == 0 && out_->reports.dropped() == 0 ? descriptor_status::ok
                                                                       : descriptor_status::capacity;
  }

 private:
  static constexpr std::uint8_t long_item = 0xfe;
  static constexpr std::size_t deepest = 32;
  static constexpr std::size_t most_usages = 64;
  static constexpr std::size_t most_pushes = 8;

  struct item {
    std::uint8_t tag;  // tag and type, without the size
    std::size_t size;
    std::uint32_t raw;
    std::int32_t with_sign;
  };
  struct global_items {
    std::uint16_t page = 0;
    std::int32_t logical_min = 0;
    item logical_max{};
    std::int32_t physical_min = 0;
    item physical_max{};
    std::uint32_t unit = 0;
    std::int8_t exponent = 0;
    std::uint32_t report_size = 0;
    std::uint32_t report_count = 0;
    std::uint8_t report_id = 0;
  };
  // A usage of one or two bytes gets the page that is in force at the main item; one of four brings its own.
  struct usage_item {
    std::uint32_t value = 0;
    bool has_page = false;
  };

  [[nodiscard]] static std::int32_t extend(std::uint32_t raw, std::size_t size) noexcept {
    if (size == 1) return static_cast<std::int8_t>(raw);
    if (size == 2) return static_cast<std::int16_t>(raw);
    return static_cast<std::int32_t>(raw);
  }

  // A maximum has a sign where its minimum is negative: 25 ff is 255 beside a minimum of zero.
  [[nodiscard]] static std::int32_t maximum(const item& max, std::int32_t min) noexcept {
    if (min < 0) return max.with_sign;
    return static_cast<std::int32_t>(
        std::min<std::uint32_t>(max.raw, static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max())));
  }

  [[nodiscard]] descriptor_status take(const item& it) noexcept {
    switch (it.tag & 3U) {
      case 0:
        return main_item(it);
      case 1:
        return global_item(it);
      case 2:
        return local_item(it);
      default:
        return descriptor_status::bad_item;
    }
  }

  [[nodiscard]] descriptor_status main_item(const item& it) noexcept {
    descriptor_status s = descriptor_status::ok;
    switch (it.tag >> 2) {
      case 0x8:
        s = add(hid_report_kind::input, it.raw);
        break;
      case 0x9:
        s = add(hid_report_kind::output, it.raw);
        break;
      case 0xb:
        s = add(hid_report_kind::feature, it.raw);
        break;
      case 0xa:
        s = open_collection(it.raw);
        break;
      case 0xc:
        if (depth_ == 0) return descriptor_status::unbalanced;
        --depth_;
        break;
      default:
        return descriptor_status::bad_item;
    }
    usages_.clear();
    range_min_ = {};
    has_range_min_ = false;
    in_delimiter_ = false;
    return s;
  }

  [[nodiscard]] descriptor_status open_collection(std::uint32_t kind) noexcept {
    if (depth_ == deepest) return descriptor_status::too_large;
    if (kind == 1 && !usages_.empty()) {
      top_page_ = page_of(usages_[0]);
      top_usage_ = static_cast<std::uint16_t>(usages_[0].value);
    }
    ++depth_;
    return descriptor_status::ok;
  }

  [[nodiscard]] descriptor_status global_item(const item& it) noexcept {
    switch (it.tag >> 2) {
      case 0x0:
        if (it.raw > 0xffff) return descriptor_status::bad_item;
        now_.page = static_cast<std::uint16_t>(it.raw);
        break;
      case 0x1:
        now_.logical_min = it.with_sign;
        break;
      case 0x2:
        now_.logical_max = it;
        break;
      case 0x3:
        now_.physical_min = it.with_sign;
        break;
      case 0x4:
        now_.physical_max = it;
        break;
      case 0x5:  // four bits with a sign, as the specification has it; some devices give a whole byte
        now_.exponent = static_cast<std::int8_t>(it.raw <= 7    ? static_cast<int>(it.raw)
                                                 : it.raw <= 15 ? static_cast<int>(it.raw) - 16
                                                                : std::clamp(it.with_sign, -8, 7));
        break;
      case 0x6:
        now_.unit = it.raw;
        break;
      case 0x7:
        if (it.raw > 4096) return descriptor_status::too_large;
        now_.report_size = it.raw;
        break;
      case 0x8:
        if (it.raw == 0 || it.raw > 255) return descriptor_status::bad_item;
        now_.report_id = static_cast<std::uint8_t>(it.raw);
        out_->numbered = true;
        break;
      case 0x9:
        if (it.raw > report_descriptor::max_report_bits) return descriptor_status::too_large;
        now_.report_count = it.raw;
        break;
      case 0xa:
        if (pushed_ == most_pushes) return descriptor_status::too_large;
        stack_[pushed_++] = now_;
        break;
      case 0xb:
        if (pushed_ == 0) return descriptor_status::unbalanced;
        now_ = stack_[--pushed_];
        break;
      default:
        return descriptor_status::bad_item;
    }
    return descriptor_status::ok;
  }

  [[nodiscard]] descriptor_status local_item(const item& it) noexcept {
    const usage_item usage{it.raw, it.size == 4};
    switch (it.tag >> 2) {
      case 0x0:
        if (in_delimiter_ && delimited_++ > 0) break;  // of usages that stand for one another the first is taken
        add_usage(usage);
        break;
      case 0x1:
        range_min_ = usage;
        has_range_min_ = true;
        break;
      case 0x2:
        if (!has_range_min_ || range_min_.has_page != usage.has_page || usage.value < range_min_.value ||
            (usage.has_page && (usage.value >> 16) != (range_min_.value >> 16))) {
          return descriptor_status::bad_item;
        }
        // More usages than there is room for are more than a report has fields for: the rest is left away, and the
        // fields beyond them take the last one.
        for (std::uint32_t u = range_min_.value; !usages_.full(); ++u) {
          add_usage({u, usage.has_page});
          if (u == usage.value) break;
        }
        has_range_min_ = false;
        break;
      case 0xa:
        in_delimiter_ = it.raw != 0;
        delimited_ = 0;
        break;
      default:  // designators, strings and reserved ones change nothing here
        break;
    }
    return descriptor_status::ok;
  }

  void add_usage(const usage_item& u) noexcept { static_cast<void>(usages_.push_back(u)); }

  [[nodiscard]] std::uint16_t page_of(const usage_item& u) const noexcept {
    return u.has_page ? static_cast<std::uint16_t>(u.value >> 16) : now_.page;
  }

  [[nodiscard]] descriptor_status add(hid_report_kind kind, std::uint32_t flags) noexcept {
    hid_report_size* report = nullptr;
    for (hid_report_size& r : out_->reports) {
      if (r.kind == kind && r.report_id == now_.report_id) report = &r;
    }
    if (report == nullptr) {
      if (!out_->reports.push_back({kind, now_.report_id, 0})) return descriptor_status::ok;  // counted as dropped
      report = &out_->reports.back();
    }
    const std::uint64_t more = std::uint64_t{now_.report_size} * now_.report_count;
    if (report->bits + more > report_descriptor::max_report_bits) return descriptor_status::too_large;
    const std::uint32_t first = report->bits;
    report->bits += static_cast<std::uint32_t>(more);

    const bool constant = (flags & 1U) != 0;
    if (constant || now_.report_size == 0) return descriptor_status::ok;  // padding
    if (now_.report_size > 32) return descriptor_status::ok;              // a block of bytes, not a number
    hid_field f;
    f.kind = kind;
    f.report_id = now_.report_id;
    f.bit_size = now_.report_size;
    f.logical_min = now_.logical_min;
    f.logical_max = maximum(now_.logical_max, now_.logical_min);
    f.physical_min = now_.physical_min;
    f.physical_max = maximum(now_.physical_max, now_.physical_min);
    if (f.physical_min == 0 && f.physical_max == 0) {
      f.physical_min = f.logical_min;
      f.physical_max = f.logical_max;
    }
    f.unit = now_.unit;
    f.unit_exponent = now_.exponent;
    f.array = (flags & 2U) == 0;
    f.relative = (flags & 4U) != 0;
    f.top_page = top_page_;
    f.top_usage = top_usage_;
    for (std::uint32_t i = 0; i < now_.report_count; ++i) {
      usage_item u;
      if (!usages_.empty()) u = usages_[f.array ? 0 : std::min<std::size_t>(i, usages_.size() - 1)];
      f.usage_page = page_of(u);
      f.usage = static_cast<std::uint16_t>(u.value);
      f.bit_offset = first + i * now_.report_size;
      if (!out_->fields.push_back(f) && out_->fields.dropped() > report_descriptor::max_bytes) break;
    }
    return descriptor_status::ok;
  }

  std::span<const std::uint8_t> bytes_;
  report_descriptor* out_;
  global_items now_{};
  std::array<global_items, most_pushes> stack_{};
  std::size_t pushed_ = 0;
  std::size_t depth_ = 0;
  fixed_vector<usage_item, most_usages> usages_{};
  usage_item range_min_{};
  bool has_range_min_ = false;
  bool in_delimiter_ = false;
  std::uint32_t delimited_ = 0;
  std::uint16_t top_page_ = 0;
  std::uint16_t top_usage_ = 0;
};

}  // namespace

report_descriptor parse_report_descriptor(std::span<const std::uint8_t> bytes) noexcept {
  report_descriptor out;
  const descriptor_status s = descriptor_parser(bytes, out).run();
  if (s != descriptor_status::ok && s != descriptor_status::capacity) out = {};
  out.status = s;
  return out;
}

}  // namespace asperity
