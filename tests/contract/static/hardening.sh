#!/usr/bin/env bash
# The built programs are hardened, and what they were hardened with is in no file that a consumer sees.
#   hardening.sh FORTIFIED FOLDER-OF-THE-BUILD PROGRAM...    FORTIFIED: 1 where the build has optimised C library calls
set -euo pipefail
fortified=$1
build=$2
shift 2
faults=0
fault() { echo "$1: $2"; faults=1; }
for program in "$@"; do
  header=$(readelf -hW "$program")
  segments=$(readelf -lW "$program")
  dynamic=$(readelf -dW "$program")
  symbols=$(readelf -sW --dyn-syms "$program")
  grep -qE 'Type: +DYN' <<< "$header" || fault "$program" "is not position-independent (PIE)"
  grep -q 'GNU_RELRO' <<< "$segments" || fault "$program" "has no segment that becomes read-only (RELRO)"
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<< "$dynamic" || fault "$program" "binds lazily, so its RELRO is not full"
  grep -qE 'GNU_STACK +0x[0-9a-f]+ 0x[0-9a-f]+ 0x[0-9a-f]+ 0x[0-9a-f]+ 0x[0-9a-f]+ RW +' <<< "$segments" || fault "$program" "has an executable stack"
  grep -q '__stack_chk_fail' <<< "$symbols" || fault "$program" "has no stack protector"
  if [[ $fortified == 1 ]]; then
    grep -qE ' __[a-z]+_chk(@|$)' <<< "$symbols" || fault "$program" "calls the C library without its checks (_FORTIFY_SOURCE)"
  fi
done
# What is installed for find_package(): written when the build is configured.
exports=$(find "$build/CMakeFiles/Export" -name 'asperity-*.cmake')
[[ -n $exports ]] || fault "$build" "has no export files to look into"
if grep -lE 'stack-protector|stack-clash|FORTIFY|-z,(now|relro)|-pie|asperity_hardening' $exports; then
  fault "these files" "tell a consumer of the hardening"
fi
exit $faults
