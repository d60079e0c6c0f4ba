#!/usr/bin/env bash
# touched.sh COMMAND FOLDER: runs the golden session, which must touch something, and leaves it in FOLDER/first/golden.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
"$here/session.sh" "$1" "$2/first"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) if ($i == "contacts") column = i; next }
  $column > 0 { touched++ }
  END {
    printf "%d of %d ticks in contact\n", touched, NR - 1
    exit !(NR > 1000 && touched > 100)
  }' "$2/first/golden/recording.csv"
