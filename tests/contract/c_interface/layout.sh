#!/usr/bin/env bash
# layout.sh COMPILER INCLUDE WORK: the layout of the C interface's headers, each of which stands alone; see planted_layout.sh.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
compiler=$1 include=$2 folder=asperity/c claims=$here/layout.h work=$3/planted
source "$here/../abi/planted_layout.sh"
for header in "$include/$folder"/*.h; do
  "$compiler" "${as_c[@]}" -I"$include" "$header"
done
holds

# A field more at the end of every struct and one less, another width, two that change places, other values.
plant answer.h 's/char message\[504\];/char message[496];/'
plant model.h 's/^(  double dynamic_friction;)/\1 double planted;/'
plant model.h 's/^  uint64_t full_triangles;/  uint32_t full_triangles;/'
plant model.h 's/^(  double inertia_per_mass_m2\[9\];)/\1 double planted;/'
plant renderer.h 's/^  uint32_t grid;/  uint64_t grid;/'
plant renderer.h 's/^  double centre_of_mass_m\[3\];/  double centre_of_mass_m[4];/'
plant renderer.h 's/^(  double n_ab\[3\];)/\1 double planted;/'
plant tool.h 's/coupling_n_per_m;/OTHER;/; s/coupling_n_m_per_rad;/coupling_n_per_m;/; s/OTHER;/coupling_n_m_per_rad;/'
plant tool.h '/^  double most_torque_n_m;/d'
plant tool.h 's/^  uint32_t threads;/  uint64_t threads;/'
plant tool.h 's/^(  double deepest_m;)/\1 double planted;/'
plant device.h 's/^  int64_t delay_ns;/  int32_t delay_ns;/'
plant device.h 's/^(  double nominal_rate_hz;)/\1 double planted;/'
plant device.h 's/^  double pose\[7\];/  double pose[8];/'
plant session.h 's/^  int64_t time_ns;/  uint64_t planted; int64_t time_ns;/'
plant session.h '/^  double mass_kg;/d'
plant session.h 's/^(  uint32_t reserved;)/\1 double planted;/'
plant answer.h 's/(ASPERITY_STATUS_NOT_READY) 5/\1 6/'
plant answer.h 's/(ASPERITY_ERROR_BUSY) 72/\1 71/'
plant renderer.h 's/(ASPERITY_FORMULATION_PLANES) 2/\1 1/'
plant device.h 's/(ASPERITY_HAND_FIRM) 2/\1 1/'
echo "$planted planted changes were seen in C and in C++"
