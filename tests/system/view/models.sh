#!/usr/bin/env bash
# models.sh ASPERITY FOLDER: a block and a gear, baked small, for the tests of the page.
set -euo pipefail
mkdir -p "$2"
for model in block gear; do
  [[ $2/$model.glb -nt $1 ]] && continue
  "$1" models --only "$model" -o "$2" --quiet
  "$1" bake "$2/$model.ply" --triangles 300 --texture 256 -o "$2/$model.glb" --quiet
done
