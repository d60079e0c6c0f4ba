# shellcheck shell=bash
# The main job end to end: two meshes in, a felt session out. Sourced by ./dev.

# fresh OUTPUT INPUT...: the output exists and is not older than any input.
fresh() {
  local output=$1 input
  shift
  [[ -e $output ]] || return 1
  for input in "$@"; do
    [[ $input -nt $output ]] && return 1
  done
  return 0
}

run_demo() {
  setup
  configure_and_build release bin/asperity
  local asperity=build/release/bin/asperity models=out/models out=out/demo model
  mkdir -p "$models" "$out"

  # Triangle counts of the coarse meshes: Table 1 of the paper.
  local -A triangles=([file]=632 [cad_part]=720)
  for model in file cad_part; do
    if ! fresh "$models/$model.ply" "$asperity"; then
      step "make $model"
      "$asperity" models --only "$model" -o "$models"
    fi
    if ! fresh "$out/$model.glb" "$models/$model.ply"; then
      step "bake $model"
      "$asperity" bake "$models/$model.ply" --triangles "${triangles[$model]}" -o "$out/$model.glb"
    fi
  done

  step "feel the CAD part with the file: 3 s at 1 kHz, simulated device"
  "$asperity" run --probe "$out/file.glb" --fixed "$out/cad_part.glb" --device simulated --seconds 3 \
    --record "$out/recording.csv" --plot "$out/plot.png"
  say
  say "recording: $out/recording.csv"
  say "plot:      $out/plot.png"
}
