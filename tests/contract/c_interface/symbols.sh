#!/usr/bin/env bash
# symbols.sh LIBRARY LIST HEADERS: the library shows the names of LIST and no other, and its headers declare them all.
set -euo pipefail
library=$1 list=$2 headers=$3
shown=$(nm -D --defined-only "$library" | awk '{ print $3 }' | LC_ALL=C sort)
declared=$(cat "$headers"/*.h | sed -nE 's/^ASPERITY_C_API [a-z0-9_ *]*\b(asperity_[a-z_]+)\(.*/\1/p' | LC_ALL=C sort)
if ! diff <(LC_ALL=C sort "$list") <(echo "$shown"); then
  echo "the library's names are not those of $list" >&2
  exit 1
fi
if ! diff "$list" <(echo "$declared"); then
  echo "the headers' names are not those of $list" >&2
  exit 1
fi
# Of C alone: no name of C++ can be asked for, so none is there that another library could be bound to.
[[ $(wc -l < "$list") -ge 40 ]] || { echo "only $(wc -l < "$list") names: the search is broken" >&2; exit 1; }
echo "$(wc -l < "$list") names"
