# shellcheck shell=bash
# What the tests of the scripts behind ./dev share: `is` compares, and `failed` says at the end whether something was not.
failed=0

# is WHAT FOUND WANTED
is() {
  [[ $2 == "$3" ]] && return
  printf '%s: %s\n--- wanted\n%s\n--- found\n%s\n' "${0##*/}" "$1" "$3" "$2"
  failed=1
}
