#!/usr/bin/env bash
# layout.sh COMPILER INCLUDE WORK: compiles layout.h as strict C99 and as C++20, then plants changes in copies of
# driver_abi.h, each of which has to break both.
set -euo pipefail
compiler=$1 include=$2 work=$3/planted
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
header=$include/asperity/device/driver_abi.h
as_c=(-x c -std=c99 -Wall -Wextra -pedantic -Werror -fsyntax-only)
as_cxx=(-x c++ -std=c++20 -Wall -Wextra -Wpedantic -Werror -fsyntax-only)

compile() { # FOLDER OPTIONS...
  local folder=$1
  shift
  "$compiler" "$@" -I"$folder" -include "$here/layout.h" /dev/null
}

for options in as_c as_cxx; do
  declare -n flags=$options
  compile "$include" "${flags[@]}"
done

rm -rf "$work"
mkdir -p "$work/asperity/device"
planted=0
# plant SED-SCRIPT: changes a copy, and expects neither language to take it.
plant() {
  sed -E "$1" "$header" > "$work/asperity/device/driver_abi.h"
  if cmp -s "$header" "$work/asperity/device/driver_abi.h"; then
    echo "the change '$1' changes nothing" >&2
    exit 1
  fi
  for options in as_c as_cxx; do
    declare -n flags=$options
    if compile "$work" "${flags[@]}" 2> "$work/errors"; then
      echo "the change '$1' was not seen" >&2
      exit 1
    fi
    grep -qE '_has_moved|_has_another' "$work/errors" || {
      echo "the change '$1' broke something else:" >&2
      cat "$work/errors" >&2
      exit 1
    }
  done
  planted=$((planted + 1))
}

# A field more before one of every struct, one less, one of another width, two that change places, other values.
for field in 'double peak_force_n' 'char name\[ASPERITY_NAME_SIZE\]' 'double position_d_m' 'uint32_t buttons' \
  'double torque_d_n_m' 'char path' 'const char\* licence' 'void\* context;' 'int32_t \(\*disarm\)' \
  'int32_t \(\*applied\)'; do
  plant "s/^  ($field)/  uint64_t planted; \\1/"
done
plant '/^  double rotation_resolution_rad;/d'
plant '/^  int32_t \(\*clear_fault\)/d'
plant 's/^  uint64_t reserved\[8\];/  uint64_t reserved[7];/'
plant 's/^  int64_t worst_latency_ns;/  int32_t worst_latency_ns;/'
plant 's/continuous_force_n;/PEAK;/; s/peak_force_n;/continuous_force_n;/; s/PEAK;/peak_force_n;/'
plant 's/(ASPERITY_STATE_READY) 3/\1 2/'
plant 's/(ASPERITY_NOT_READY) 1/\1 9/'
plant 's/(ASPERITY_PATH_SIZE) 256/\1 255/'
echo "$planted planted changes were seen in C and in C++"
