#!/usr/bin/env bash
# repeatable.sh COMMAND FOLDER: the same session twice gives the same bytes, and the session did touch something.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
for run in first second; do
  "$here/session.sh" "$1" "$2/$run"
  (cd "$2/$run/golden" && sha256sum -- *) | tee "$2/$run.sha256"
done
cmp "$2/first.sha256" "$2/second.sha256"

awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) if ($i == "contacts") column = i; next }
  $column > 0 { touched++ }
  END {
    printf "%d of %d ticks in contact\n", touched, NR - 1
    exit !(NR > 1000 && touched > 100)
  }' "$2/first/golden/recording.csv"
