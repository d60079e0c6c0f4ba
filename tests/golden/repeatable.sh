#!/usr/bin/env bash
# repeatable.sh COMMAND FOLDER: the same session twice gives the same bytes, and a session that did nothing is no proof.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
for run in first second; do
  "$here/session.sh" "$1" "$2/$run"
  (cd "$2/$run/golden" && sha256sum -- *) | tee "$2/$run.sha256"
done
cmp "$2/first.sha256" "$2/second.sha256"

rows=$(wc -l < "$2/first/golden/recording.csv")
[[ $rows -gt 400 ]] || {
  echo "the recording of half a second has only $rows lines" >&2
  exit 1
}
