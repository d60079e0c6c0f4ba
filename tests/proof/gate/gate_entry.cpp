// The gate's function with arguments that a solver can name: what prove_gate translates, and what it runs.
#include "asperity/device/gate_function.hpp"

// `out` receives the three components, then 1 or 0 for finite and for certified.
extern "C" void gate(double wanted_x, double wanted_y, double wanted_z, double previous_x, double previous_y,
                     double previous_z, double limit, double saturation, double max_change, bool allowed, double* out);

extern "C" void gate(double wanted_x, double wanted_y, double wanted_z, double previous_x, double previous_y,
                     double previous_z, double limit, double saturation, double max_change, bool allowed, double* out) {
  const asperity::bounded_vector left = asperity::bound_vector(
      {wanted_x, wanted_y, wanted_z}, {previous_x, previous_y, previous_z}, {limit, saturation, max_change}, allowed);
  out[0] = left.value.x;
  out[1] = left.value.y;
  out[2] = left.value.z;
  out[3] = left.finite ? 1.0 : 0.0;
  out[4] = left.certified ? 1.0 : 0.0;
}
