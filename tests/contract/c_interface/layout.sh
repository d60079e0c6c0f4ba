#!/usr/bin/env bash
# layout.sh COMPILER INCLUDE WORK: compiles layout.h as strict C99 and as C++20, then plants changes in copies of the
# headers of the C interface, each of which has to break both.
set -euo pipefail
compiler=$1 include=$2 work=$3/planted
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
as_c=(-x c -std=c99 -Wall -Wextra -Wpedantic -Werror -fsyntax-only)
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
# Every header stands alone.
for header in "$include"/asperity/c/*.h; do
  "$compiler" "${as_c[@]}" -I"$include" "$header"
done

planted=0
# plant HEADER SED-SCRIPT: changes a copy, and expects neither language to take it.
plant() {
  rm -rf "$work"
  mkdir -p "$work/asperity"
  cp -r "$include/asperity/c" "$work/asperity/c"
  sed -i -E "$2" "$work/asperity/c/$1"
  if cmp -s "$include/asperity/c/$1" "$work/asperity/c/$1"; then
    echo "the change '$2' changes nothing" >&2
    exit 1
  fi
  for options in as_c as_cxx; do
    declare -n flags=$options
    if compile "$work" "${flags[@]}" 2> "$work/errors"; then
      echo "the change '$2' was not seen" >&2
      exit 1
    fi
    grep -qE '_has_moved|_has_another' "$work/errors" || {
      echo "the change '$2' broke something else:" >&2
      cat "$work/errors" >&2
      exit 1
    }
  done
  planted=$((planted + 1))
}

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
plant tool.h 's/^(  double deepest_m;)/\1 double planted;/'
plant device.h 's/^  int64_t delay_ns;/  int32_t delay_ns;/'
plant device.h 's/^(  double nominal_rate_hz;)/\1 double planted;/'
plant device.h 's/^  double pose\[7\];/  double pose[8];/'
plant session.h 's/^  int64_t time_ns;/  uint64_t planted; int64_t time_ns;/'
plant session.h '/^  double mass_kg;/d'
plant answer.h 's/(ASPERITY_STATUS_NOT_READY) 5/\1 6/'
plant answer.h 's/(ASPERITY_ERROR_BUSY) 72/\1 71/'
plant renderer.h 's/(ASPERITY_FORMULATION_PLANES) 2/\1 1/'
plant device.h 's/(ASPERITY_HAND_FIRM) 2/\1 1/'
echo "$planted planted changes were seen in C and in C++"
