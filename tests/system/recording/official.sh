#!/usr/bin/env bash
# official.sh WORK MODULES: the official reader, npm's @mcap/core in the folder MODULES, reads WORK/s.mcap. Exits with 77, and says
# why, where it or Node.js is not there.
set -euo pipefail
work=$1 modules=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if ! command -v node > /dev/null || [[ ! -d $modules/@mcap/core ]]; then
  echo "SKIPPED: there is no Node.js, or no @mcap/core in $modules (./dev interop fetches it)"
  exit 77
fi
rows=$(($(wc -l < "$work/s.csv") - 1))
ASPERITY_NODE_MODULES=$modules node "$here/read_official.mjs" "$work/s.mcap" "$rows"
