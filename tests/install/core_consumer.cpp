// A program of a consumer of the header-only core.
#include <cstdio>

#include <asperity/asperity.hpp>

int main() {
  const asperity::wrench at_tip{{0.0, 0.0, 2.0}, {0.0, 0.0, 0.0}};
  const asperity::wrench at_centre = asperity::transport(at_tip, {0.1, 0.0, 0.0}, {0.0, 0.0, 0.0});
  std::printf("torque about the centre: %g N m\n", at_centre.torque.y);
  return at_centre.torque.y == -0.2 ? 0 : 1;
}
