#!/usr/bin/env bash
# command.sh COMMAND MODELS WORK: a session of the command in three formats, read by read_recordings.py; the same bytes again.
set -euo pipefail
command=$1 models=$2 work=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$work"
mkdir -p "$work"
for format in csv npz mcap; do
  "$command" --quiet run --probe "$models/block.glb" --fixed "$models/gear.glb" --seconds 1 --record "$work/s.$format"
done
python=/usr/bin/python3
[[ -x $python ]] || python=python3
"$python" "$here/read_recordings.py" "$work/s.csv" "$work/s.npz" "$work/s.mcap"
# The same bytes again.
"$command" --quiet run --probe "$models/block.glb" --fixed "$models/gear.glb" --seconds 1 --record "$work/again.npz"
mkdir "$work/again"
"$command" --quiet run --probe "$models/block.glb" --fixed "$models/gear.glb" --seconds 1 --record "$work/again/s.mcap"
cmp "$work/s.npz" "$work/again.npz"
cmp "$work/s.mcap" "$work/again/s.mcap"
cmp "$work/metadata.yaml" "$work/again/metadata.yaml"
# Another recording's description stays.
if "$command" --quiet run --probe "$models/block.glb" --fixed "$models/gear.glb" --seconds 0.1 --record "$work/other.mcap" 2> "$work/said"; then
  echo "metadata.yaml of another recording was overwritten"
  exit 1
fi
grep -q "a folder of its own" "$work/said"
