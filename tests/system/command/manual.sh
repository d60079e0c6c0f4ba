#!/usr/bin/env bash
# The manual page names every subcommand and every option that the command offers, and completion offers them too.
#   manual.sh ASPERITY FOLDER-OF-THE-MANUAL
set -euo pipefail
command=$1
manual=$2
page=$(sed 's/\\-/-/g' "$manual/asperity.1")
missing=0

options_of() { "$command" "$@" --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+'; }

source "$manual/asperity.bash"
completed() { # completed WORD...: what completion offers after these words
  COMP_WORDS=("$command" "$@")
  COMP_CWORD=$#
  _asperity
  printf '%s\n' "${COMPREPLY[@]}"
}

subcommands=$("$command" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p')
[[ -n $subcommands ]] || { echo "the command lists no subcommand"; exit 1; }
for subcommand in $subcommands; do
  grep -qE "^\.SS $subcommand( |$)" <<< "$page" || { echo "the manual has no section on '$subcommand'"; missing=1; }
  completed "" | grep -x -- "$subcommand" > /dev/null || { echo "completion does not offer '$subcommand'"; missing=1; }
  for option in $(options_of "$subcommand"); do
    grep -qE -- "(^|[^a-z-])$option([^a-z-]|$)" <<< "$page" || { echo "the manual does not name $option of $subcommand"; missing=1; }
    completed "$subcommand" "--" | grep -x -- "$option" > /dev/null || { echo "completion does not offer $option of $subcommand"; missing=1; }
  done
done
exit $missing
