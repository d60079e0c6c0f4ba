// run_gate BITS x 9 ALLOWED: calls the compiled gate once. Every double is given and answered as its 64 bits in hex.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" void gate(double, double, double, double, double, double, double, double, double, bool, double*);

int main(int argc, char** argv) {
  if (argc != 11) return 2;
  double in[9];
  for (int i = 0; i < 9; ++i) {
    const std::uint64_t bits = std::strtoull(argv[i + 1], nullptr, 16);
    std::memcpy(&in[i], &bits, sizeof bits);
  }
  double out[5];
  gate(in[0], in[1], in[2], in[3], in[4], in[5], in[6], in[7], in[8], argv[10][0] == '1', out);
  for (const double x : out) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    std::printf("%016llx\n", static_cast<unsigned long long>(bits));
  }
}
