#!/usr/bin/env bash
# check_model.sh MODEL WORK holds|breaks [-DFAULT]
# Has spin check every interleaving of a model. "holds": no assertion fails and no process is stuck. "breaks": the
# planted fault is found.
set -euo pipefail
model=$(realpath "$1") work=$2 expected=$3
shift 3

for tool in spin cc; do
  if ! command -v "$tool" > /dev/null; then
    echo "SKIPPED: $tool is missing (Debian: spin, gcc)"
    exit 77
  fi
done

rm -rf "$work"
mkdir -p "$work"
cd "$work"
spin "$@" -a "$model"
cc -O1 -DSAFETY -o pan pan.c
# Depth and table are large enough for the correct model; a search that was cut short fails below.
./pan -m100000 -w20 | tee pan.out

grep -q 'errors: ' pan.out
if grep -q 'max search depth too small' pan.out; then
  echo "the search was cut short: raise its depth"
  exit 1
fi
case "$expected" in
  holds) grep -q 'errors: 0$' pan.out && grep -E 'states, stored' pan.out ;;
  breaks) grep -qE 'assertion violated|invalid end state' pan.out ;;
  *) exit 2 ;;
esac
