#!/usr/bin/env bash
# One short session from nothing: session.sh COMMAND FOLDER. What it leaves in FOLDER/golden must not depend on the build
# type, on the compiler or on the day: two baked models and the recording of a simulated session.
set -euo pipefail
asperity=$(realpath "$1")
mkdir -p "$2"
cd "$2"
rm -rf golden models
mkdir golden

for model in block gear; do
  "$asperity" --quiet models --only "$model" -o models
  "$asperity" --quiet bake "models/$model.ply" --coarse "models/${model}_coarse.ply" --texture 256 -o "golden/$model.glb"
done
"$asperity" --quiet run --probe golden/block.glb --fixed golden/gear.glb --device simulated --seconds 0.5 \
  --record golden/recording.csv
