#!/usr/bin/env bash
# readme_shows.sh README EXAMPLE: the README's C++ block is the example, letter for letter, and has at most 30 lines of code.
set -euo pipefail
block=$(awk '/^```cpp$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$1")
diff <(printf '%s\n' "$block") "$2" || {
  echo "the C++ block of $1 and $2 differ; copy the example into the README" >&2
  exit 1
}
code=$(grep -cvE '^[[:space:]]*(//|$)' "$2")
[[ $code -le 30 ]] || {
  echo "$2 has $code lines of code; it is meant to have 30 at most" >&2
  exit 1
}
