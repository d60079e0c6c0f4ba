# shellcheck shell=bash
# The moving picture at the top of README.md: the live page while a file scrubs a CAD part. Sourced by ./dev.

run_moving_picture() {
  packages+=(python3-pil)
  setup
  configure_and_build release bin/asperity
  bake_demo_models
  step "film the page"
  mkdir -p out/moving-picture
  PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tools/dev/moving_picture.py build/release/bin/asperity \
    out/demo/file.glb out/demo/cad_part.glb out/moving-picture/live-page.gif
  say "copy it to docs/pictures/live-page.gif when it has been looked at"
}
