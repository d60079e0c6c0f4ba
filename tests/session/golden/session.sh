#!/usr/bin/env bash
# One short session from nothing: session.sh COMMAND FOLDER. What it leaves in FOLDER/golden must not depend on the build
# type, on the compiler or on the day: three baked models and the recording of a simulated session.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
golden=$2/golden
rm -rf "$golden"

"$here/../../support/block_and_gear.sh" "$1" "$golden"
# The others bring their coarse mesh: this one is simplified, and gets a relief.
"$1" --quiet bake "$golden/full/gear.ply" --triangles 300 --texture 128 --procedural noise --rms 2e-5 --seed 3 \
  --wavelengths 0.004,0.02 -o "$golden/rough_gear.glb"
rm -r "$golden/full"
"$1" --quiet run --probe "$golden/block.glb" --fixed "$golden/gear.glb" --device simulated --seconds 1 \
  --record "$golden/recording.csv"
