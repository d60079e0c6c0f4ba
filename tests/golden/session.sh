#!/usr/bin/env bash
# One short session from nothing: session.sh COMMAND FOLDER. What it leaves in FOLDER/golden must not depend on the build
# type, on the compiler or on the day: two baked models and the recording of a simulated session.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
golden=$2/golden
rm -rf "$golden"

"$here/../support/block_and_gear.sh" "$1" "$golden"
rm -r "$golden/full"
"$1" --quiet run --probe "$golden/block.glb" --fixed "$golden/gear.glb" --device simulated --seconds 1 \
  --record "$golden/recording.csv"
