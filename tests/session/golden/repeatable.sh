#!/usr/bin/env bash
# repeatable.sh COMMAND FOLDER: the golden session again gives the bytes that touched.sh left there.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
"$here/session.sh" "$1" "$2/second"
for run in first second; do
  (cd "$2/$run/golden" && sha256sum -- *) | tee "$2/$run.sha256"
done
[[ -s $2/first.sha256 ]]
cmp "$2/first.sha256" "$2/second.sha256"
