#!/usr/bin/env bash
# layout.sh COMPILER INCLUDE WORK: the layout of driver_abi.h; see planted_layout.sh.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
compiler=$1 include=$2 folder=asperity/device claims=$here/layout.h work=$3/planted
source "$here/planted_layout.sh"
holds

# A field more before one of every struct, one less, one of another width, two that change places, other values.
for field in 'double peak_force_n' 'char name\[ASPERITY_NAME_SIZE\]' 'double position_d_m' 'uint32_t buttons' \
  'double torque_d_n_m' 'char path' 'const char\* licence' 'void\* context;' 'int32_t \(\*disarm\)' \
  'int32_t \(\*applied\)'; do
  plant driver_abi.h "s/^  ($field)/  uint64_t planted; \\1/"
done
plant driver_abi.h '/^  double rotation_resolution_rad;/d'
plant driver_abi.h '/^  int32_t \(\*clear_fault\)/d'
plant driver_abi.h 's/^  uint64_t reserved\[8\];/  uint64_t reserved[7];/'
plant driver_abi.h 's/^  int64_t worst_latency_ns;/  int32_t worst_latency_ns;/'
plant driver_abi.h 's/continuous_force_n;/PEAK;/; s/peak_force_n;/continuous_force_n;/; s/PEAK;/peak_force_n;/'
plant driver_abi.h 's/(ASPERITY_STATE_READY) 3/\1 2/'
plant driver_abi.h 's/(ASPERITY_NOT_READY) 1/\1 9/'
plant driver_abi.h 's/(ASPERITY_PATH_SIZE) 256/\1 255/'
echo "$planted planted changes were seen in C and in C++"
