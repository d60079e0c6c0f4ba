#include "asperity/plugin/elf_check.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <elf.h>
#include <link.h>
#include <string_view>
#include <vector>

#include "asperity/device/driver_abi.h"

namespace asperity::plugin {
namespace {

using header = ElfW(Ehdr);
using segment = ElfW(Phdr);
using dynamic_item = ElfW(Dyn);
using symbol = ElfW(Sym);
using hash_word = std::uint32_t;  // of both hash tables, on the machines that are named below
using bloom_word = ElfW(Addr);

constexpr std::size_t most_segments = 128;
constexpr std::size_t most_dynamic_items = 4096;
constexpr std::uint32_t longest_chain = 1U << 16;

#if defined(__x86_64__)
constexpr std::uint16_t this_machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr std::uint16_t this_machine = EM_AARCH64;
#elif defined(__i386__)
constexpr std::uint16_t this_machine = EM_386;
#elif defined(__arm__)
constexpr std::uint16_t this_machine = EM_ARM;
#elif defined(__riscv)
constexpr std::uint16_t this_machine = EM_RISCV;
#else
#error "name the ELF machine of this processor, so that drivers for others are refused before they are loaded"
#endif
constexpr unsigned char this_class = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
constexpr unsigned char this_order = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;

elf_problem unusable(std::string why) { return {false, std::move(why)}; }

// The parts of a shared object that finding a symbol takes. Addresses are those that the file gives itself.
class elf_file {
 public:
  explicit elf_file(const file_reader& read) : read_(read) {}

  std::optional<elf_problem> open() {
    header h{};
    if (!get(0, h) || std::memcmp(&h.e_ident[0], ELFMAG, SELFMAG) != 0) {
      return unusable("is not a shared object: it has no ELF header");
    }
    if (h.e_ident[EI_CLASS] != this_class || h.e_ident[EI_DATA] != this_order || h.e_machine != this_machine) {
      return unusable("is built for another processor than this program: build it for this machine");
    }
    if (h.e_type != ET_DYN || h.e_ident[EI_VERSION] != EV_CURRENT) {
      return unusable("is not a shared object: link it with -shared");
    }
    if (h.e_phentsize != sizeof(segment) || h.e_phnum == 0 || h.e_phnum > most_segments) {
      return unusable("is a damaged shared object: its program headers cannot be");
    }
    segments_.resize(h.e_phnum);
    if (!read_(h.e_phoff, std::as_writable_bytes(std::span(segments_)))) {
      return unusable("is a damaged shared object: its program headers lie beyond its end");
    }
    return read_dynamic();
  }

  // Where the driver's function is, or why it is not there.
  [[nodiscard]] std::optional<elf_problem> find(std::string_view name) const {
    if (symbols_ == 0 || strings_ == 0 || (gnu_hash_ == 0 && hash_ == 0)) {
      return unusable("is a damaged shared object: it has no table of dynamic symbols");
    }
    const std::optional<bool> found = gnu_hash_ != 0 ? find_by_gnu_hash(name) : find_by_hash(name);
    if (!found) return unusable("is a damaged shared object: its table of dynamic symbols leads nowhere");
    if (*found) return std::nullopt;
    return elf_problem{true, "is not a driver: it does not export " ASPERITY_ENTRY_NAME
                             "; see driver_abi.h, or ASPERITY_EXPORT_DRIVER in driver_export.hpp"};
  }

 private:
  template <class T>
  [[nodiscard]] bool get(std::uint64_t offset, T& out) const {
    return read_(offset, std::as_writable_bytes(std::span(&out, 1)));
  }

  // What would lie at an address once the file is loaded; only what comes from the file.
  [[nodiscard]] bool get_loaded(std::uint64_t address, std::span<std::byte> out) const {
    for (const segment& s : segments_) {
      if (s.p_type != PT_LOAD || address < s.p_vaddr) continue;
      const std::uint64_t within = address - s.p_vaddr;
      if (within >= s.p_filesz || out.size() > s.p_filesz - within) continue;
      if (s.p_offset > UINT64_MAX - within) return false;
      return read_(s.p_offset + within, out);
    }
    return false;
  }
  template <class T>
  [[nodiscard]] bool get_item(std::uint64_t table, std::uint64_t index, T& out) const {
    if (index > (UINT64_MAX - table) / sizeof(T)) return false;
    return get_loaded(table + index * sizeof(T), std::as_writable_bytes(std::span(&out, 1)));
  }

  std::optional<elf_problem> read_dynamic() {
    const auto d =
        std::find_if(segments_.begin(), segments_.end(), [](const segment& s) { return s.p_type == PT_DYNAMIC; });
    if (d == segments_.end()) return unusable("is not a shared object: it has no dynamic section");
    std::uint64_t symbol_size = sizeof(symbol);
    for (std::uint64_t i = 0;; ++i) {
      dynamic_item item{};
      if (i == most_dynamic_items || !get_item(d->p_vaddr, i, item)) {
        return unusable("is a damaged shared object: its dynamic section has no end");
      }
      if (item.d_tag == DT_NULL) break;
      if (item.d_tag == DT_SYMTAB) symbols_ = item.d_un.d_ptr;
      if (item.d_tag == DT_STRTAB) strings_ = item.d_un.d_ptr;
      if (item.d_tag == DT_STRSZ) strings_size_ = item.d_un.d_val;
      if (item.d_tag == DT_SYMENT) symbol_size = item.d_un.d_val;
      if (item.d_tag == DT_HASH) hash_ = item.d_un.d_ptr;
      if (item.d_tag == DT_GNU_HASH) gnu_hash_ = item.d_un.d_ptr;
    }
    if (symbol_size != sizeof(symbol)) return unusable("is a damaged shared object: its symbols have another size");
    return std::nullopt;
  }

  // A function of this name that others can call. Nothing where the table cannot be read.
  [[nodiscard]] std::optional<bool> is_it(std::uint32_t index, std::string_view name) const {
    symbol s{};
    if (!get_item(symbols_, index, s)) return std::nullopt;
    std::string text(name.size() + 1, '?');
    if (s.st_name > strings_size_ || strings_size_ - s.st_name < text.size() ||
        !get_loaded(strings_ + s.st_name, std::as_writable_bytes(std::span(text)))) {
      return false;  // a name at the end of the table that is shorter than ours
    }
    if (std::string_view(text).substr(0, name.size()) != name || text.back() != '\0') return false;
    const unsigned type = s.st_info & 0xfU;
    const unsigned binding = s.st_info >> 4U;
    return s.st_shndx != SHN_UNDEF && type == STT_FUNC && (binding == STB_GLOBAL || binding == STB_WEAK) &&
           s.st_value != 0 && ((s.st_other & 3U) == STV_DEFAULT || (s.st_other & 3U) == STV_PROTECTED);
  }

  [[nodiscard]] std::optional<bool> find_by_gnu_hash(std::string_view name) const {
    std::uint32_t wanted = 5381;
    for (const char c : name) wanted = wanted * 33 + static_cast<unsigned char>(c);
    hash_word head[4]{};  // buckets, first symbol, bloom words, shift
    if (!get_loaded(gnu_hash_, std::as_writable_bytes(std::span(head))) || head[0] == 0) return std::nullopt;
    const std::uint64_t buckets = gnu_hash_ + sizeof head + std::uint64_t{head[2]} * sizeof(bloom_word);
    const std::uint64_t chains = buckets + std::uint64_t{head[0]} * sizeof(hash_word);
    hash_word index = 0;
    if (!get_item(buckets, wanted % head[0], index)) return std::nullopt;
    if (index == 0) return false;
    if (index < head[1]) return std::nullopt;
    for (std::uint32_t steps = 0; steps < longest_chain; ++steps, ++index) {
      hash_word hash = 0;
      if (!get_item(chains, index - head[1], hash)) return std::nullopt;
      if ((hash | 1U) == (wanted | 1U)) {
        const std::optional<bool> it = is_it(index, name);
        if (!it || *it) return it;
      }
      if ((hash & 1U) != 0) return false;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<bool> find_by_hash(std::string_view name) const {
    std::uint32_t wanted = 0;
    for (const char c : name) {
      wanted = (wanted << 4U) + static_cast<unsigned char>(c);
      const std::uint32_t high = wanted & 0xf0000000U;
      wanted ^= high >> 24U;
      wanted &= ~high;
    }
    hash_word head[2]{};  // buckets, symbols
    if (!get_loaded(hash_, std::as_writable_bytes(std::span(head))) || head[0] == 0) return std::nullopt;
    const std::uint64_t buckets = hash_ + sizeof head;
    const std::uint64_t chains = buckets + std::uint64_t{head[0]} * sizeof(hash_word);
    hash_word index = 0;
    if (!get_item(buckets, wanted % head[0], index)) return std::nullopt;
    for (std::uint32_t steps = 0; steps < longest_chain; ++steps) {
      if (index == 0) return false;
      const std::optional<bool> it = is_it(index, name);
      if (!it || *it) return it;
      if (!get_item(chains, index, index)) return std::nullopt;
    }
    return std::nullopt;
  }

  const file_reader& read_;
  std::vector<segment> segments_{};
  std::uint64_t symbols_ = 0;
  std::uint64_t strings_ = 0;
  std::uint64_t strings_size_ = 0;
  std::uint64_t hash_ = 0;
  std::uint64_t gnu_hash_ = 0;
};

}  // namespace

std::optional<elf_problem> find_elf_problem(const file_reader& read) {
  elf_file file(read);
  if (std::optional<elf_problem> problem = file.open()) return problem;
  return file.find(ASPERITY_ENTRY_NAME);
}

}  // namespace asperity::plugin
