#!/usr/bin/env bash
# links.sh ROOT: each link of the README, the docs and the notes goes to a file that is there, and to a heading of it.
# Before that it has to see a file and a heading that are planted, and are not there.
set -uo pipefail
root=$1
planted=$(mktemp -d)
trap 'rm -rf "$planted"' EXIT

# headings FILE: its headings as they stand in links.
headings() {
  sed -n 's/^#\{1,6\} //p' "$1" | sed 's/\[\([^]]*\)\]([^)]*)/\1/g' | tr '[:upper:]' '[:lower:]' |
    sed 's/[^[:alnum:] _-]//g; s/ /-/g'
}

# broken_links FILE...: "FILE: LINK" for each that goes nowhere.
broken_links() {
  local file link path heading
  for file in "$@"; do
    while read -r link; do
      path=${link%%#*} heading=
      [[ $link != *'#'* ]] || heading=${link#*#}
      [[ -z $path ]] && path=$file || path=$(dirname "$file")/$path
      if [[ ! -e $path ]] || { [[ -n $heading ]] && ! headings "$path" | grep -qxF -- "$heading"; }; then
        printf '%s: %s\n' "$file" "$link"
      fi
    done < <(awk '/^ *```/ { code = !code } !code' "$file" | sed 's/`[^`]*`//g' | grep -oE '\]\([^) ]+\)' | sed 's/^](//; s/)$//' | grep -vE '^[a-z]+:')
  done
}

printf '# One heading\n[a](page.md#one-heading) [b](gone.md) [c](#no-heading) [d](https://example.org/x) `[e](code.md)`\n' > "$planted/page.md"
found=$(broken_links "$planted/page.md")
if [[ $found != "$planted/page.md: gone.md"$'\n'"$planted/page.md: #no-heading" ]]; then
  printf 'links: what was planted is not what was found:\n%s\n' "$found"
  exit 1
fi

mapfile -t pages < <(cd "$root" && find README.md docs third_party_notes -name '*.md')
[[ ${#pages[@]} -gt 20 ]] || { printf 'links: only %d pages in %s\n' "${#pages[@]}" "$root" && exit 1; }
cd "$root" || exit
broken=$(broken_links "${pages[@]}")
[[ -z $broken ]] || { printf 'these links go nowhere:\n%s\n' "$broken" && exit 1; }
printf '%d pages\n' "${#pages[@]}"
