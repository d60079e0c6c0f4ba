# shellcheck shell=bash
# The moving picture at the top of README.md: the live page while a gear scrubs a block. Sourced by ./dev.

run_moving_picture() {
  packages+=(python3-pil)
  setup
  configure_and_build release bin/asperity
  local folder=out/moving-picture
  step "film the page"
  tests/system/view/models.sh build/release/bin/asperity "$folder/models"
  PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tools/dev/moving_picture.py build/release/bin/asperity \
    "$folder/models/gear.glb" "$folder/models/block.glb" "$folder/live-page.gif"
  say "copy it to docs/pictures/live-page.gif when it has been looked at"
}
