#!/usr/bin/env bash
# csharp.sh EXAMPLE.cs LIBRARY-FOLDER WORK PROBE.glb FIXED.glb: compiles the example with mono's compiler and runs it. Exits
# with 77, and says why, where there is no mono.
set -euo pipefail
example=$1 library=$2 work=$3
shift 3
for tool in mcs mono; do
  command -v "$tool" > /dev/null || {
    echo "skipped: there is no $tool here (Debian: mono-mcs, mono-runtime)"
    exit 77
  }
done
mkdir -p "$work"
mcs -unsafe -warnaserror -out:"$work/example.exe" "$example"
LD_LIBRARY_PATH=$library${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} mono "$work/example.exe" "$@"
