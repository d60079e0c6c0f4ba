// Stands where asperity-driver-host does, and writes noise over all the memory that it shares with the program: counts,
// codes, texts without an end, numbers that are none. A seed of n answers the first n calls, so that the program comes
// further, and then begins.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <sys/mman.h>
#include <unistd.h>

#include "asperity/plugin/child_exchange.hpp"
#include "asperity/plugin/futex.hpp"

using namespace asperity::plugin;

namespace {

template <class T>
T noise(std::mt19937_64& random) {
  T out;
  std::array<std::uint64_t, (sizeof(T) + 7) / 8> words{};
  const std::uint64_t values[] = {0, 1, 4, 0x7ff0000000000000, 0x7ff8000000000000, ~std::uint64_t{0}};
  for (std::uint64_t& w : words) w = random() % 2 == 0 ? random() : values[random() % std::size(values)];
  std::memcpy(static_cast<void*>(&out), words.data(), sizeof out);
  return out;
}

}  // namespace

int main() {
  const char* text = std::getenv("ASPERITY_HOSTILE_SEED");
  const std::uint64_t honest_until = text != nullptr ? std::strtoull(text, nullptr, 10) : 0;
  std::mt19937_64 random(honest_until);
  void* const mapped =
      ::mmap(nullptr, sizeof(child_page), PROT_READ | PROT_WRITE, MAP_SHARED, child_page_descriptor, 0);
  if (mapped == MAP_FAILED) return 1;
  // Shorter memory would end the program at its next access; the kernel refuses.
  if (::ftruncate(child_page_descriptor, 0) == 0) return 1;
  auto& page = *static_cast<child_page*>(mapped);
  const pid_t program = ::getppid();
  for (std::uint64_t n = 0; ::getppid() == program; ++n) {
    call_request asked{};
    const bool has_asked = page.call.get(asked);
    tick_request tick{};
    const bool has_tick = page.request.get(tick);

    auto answer = noise<call_answer>(random);
    answer.number = asked.number;
    answer.code = has_asked && random() % 4 != 0 ? 0 : answer.code;
    answer.stamp = n;
    if (asked.number <= honest_until) {
      answer = {};
      answer.stamp = n;
      answer.number = asked.number;
      answer.code = 0;
      answer.state = asked.call == static_cast<std::uint32_t>(child_call::open)  ? ASPERITY_STATE_READY
                     : asked.call == static_cast<std::uint32_t>(child_call::arm) ? ASPERITY_STATE_ARMED
                                                                                 : ASPERITY_STATE_PRESENT;
      for (auto* t : {&answer.name, &answer.version, &answer.licence, &answer.vendor}) std::strcpy(*t, "hostile");
      std::strcpy(answer.capabilities.name, "hostile");
    }
    page.called.put(answer);
    for (auto& item : page.listed) item.put(noise<listed_item>(random));

    auto ticked = noise<tick_answer>(random);
    ticked.stamp = n;
    if (has_tick && random() % 8 != 0) {
      ticked.reads = tick.reads;
      ticked.writes = tick.writes;
      ticked.disarms = tick.disarms;
      ticked.read_code = 0;
      ticked.write_code = 0;
      ticked.state = random() % 4 != 0 ? ASPERITY_STATE_ARMED : ticked.state;
      if (n % 3 != 0) ticked.silences = 0;
    }
    page.answer.put(ticked);
    page.phase.store(static_cast<std::uint32_t>(random()), std::memory_order_relaxed);
    if (n % 16 == 15) std::memset(mapped, static_cast<int>(random()), 256);
    ring(page.child_bell);
  }
  return 0;
}
