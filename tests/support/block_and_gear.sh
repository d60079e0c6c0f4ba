#!/usr/bin/env bash
# block_and_gear.sh COMMAND FOLDER: two small textured models, FOLDER/block.glb and FOLDER/gear.glb, for tests that need
# real files but not large ones.
set -euo pipefail
asperity=$(realpath "$1")
mkdir -p "$2"
cd "$2"

for model in block gear; do
  "$asperity" --quiet models --only "$model" -o full
  "$asperity" --quiet bake "full/$model.ply" --coarse "full/${model}_coarse.ply" --texture 256 -o "$model.glb"
done
