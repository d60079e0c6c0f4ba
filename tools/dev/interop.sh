# shellcheck shell=bash
# What a bake writes is an ordinary glTF file to everybody else: Khronos' validator and three.js say so. Sourced by ./dev.
# Needs the network once, for npm packages pinned by tools/dev/interop/package-lock.json; no test depends on it.

interop_skip() {
  say "skipped: interop: $*"
  exit 0
}

# Copies the scripts beside their packages, where Node.js finds them, and fetches the packages where they are not there.
interop_fetch() {
  local folder=$1 log=build/interop.fetch.log
  command -v node > /dev/null && command -v npm > /dev/null ||
    interop_skip "there is no Node.js here; install nodejs and npm (18 or later)"
  mkdir -p "$folder"
  cp tools/dev/interop/* "$folder"
  if ! cmp -s "$folder/package-lock.json" "$folder/fetched.lock"; then
    step "fetch the validator, three.js and a browser"
    npm ci --prefix "$folder" --ignore-scripts --no-audit --no-fund > "$log" 2>&1 ||
      interop_skip "npm could not fetch the packages, is there a network? $(grep -m 1 'npm error' "$log" || true) ($log)"
    cp "$folder/package-lock.json" "$folder/fetched.lock"
  fi
}

# Sets `browser` to the one that BROWSER_FOR_INTEROP names, or to the pinned one; where the system lacks a library of the
# latter, those of its package come to its help. Leaves it empty where none runs here.
interop_find_browser() {
  local folder=$1/browser
  browser=${BROWSER_FOR_INTEROP:-}
  [[ -z $browser && $(uname -s)-$(uname -m) == Linux-x86_64 ]] || return 0
  [[ -x $folder/chromium ]] || node "$1/unpack.mjs" "$folder"
  if ldd "$folder/chromium" | grep -q 'not found'; then
    export LD_LIBRARY_PATH=$folder/lib
    ldd "$folder/chromium" | grep -q 'not found' && return 0
  fi
  browser=$folder/chromium
}

# run_interop [MODEL.glb...]: checks the models given, or a CAD part made and baked for it.
run_interop() {
  setup
  configure_and_build release bin/asperity
  local asperity=build/release/bin/asperity folder=$PWD/build/interop out=out/interop model browser= name status=0
  interop_fetch "$folder"
  mkdir -p "$out"
  if [[ $# -eq 0 ]]; then
    step "bake a CAD part"
    "$asperity" --quiet models --only cad_part -o "$out"
    "$asperity" --quiet bake "$out/cad_part.ply" --triangles 720 --material steel -o "$out/cad_part.glb"
    set -- "$out/cad_part.glb"
  fi
  interop_find_browser "$folder"
  for model in "$@"; do
    name=$(basename "$model" .glb)
    step "$model"
    "$asperity" inspect "$model" --json > "$out/$name.json"
    node "$folder/validate.mjs" "$model" || status=1
    if [[ -z $browser ]]; then
      say "skipped: interop, three.js: no browser runs here; name a Chromium in BROWSER_FOR_INTEROP"
      continue
    fi
    node "$folder/view.mjs" "$model" "$out/$name.json" "$browser" "$out/$name.png" || status=1
  done
  say
  [[ $status -eq 0 ]] && say "interop: passed" || say "interop: FAILED"
  return "$status"
}
