#!/usr/bin/env bash
# nightly_page.sh SOURCE-FOLDER BUILD-FOLDER: docs/how-to/run-the-tests.md names the nightly entries of each group,
# and tests/nightly.groups has each group and only paths that there are.
set -uo pipefail
source_folder=$1 build_folder=$2
page=$source_folder/docs/how-to/run-the-tests.md
failed=0
complain() {
  printf 'nightly_page: %s\n' "$*"
  failed=1
}

# entries LABEL: the entries with that label. Read from what CMake wrote: a CTest that is asked in the folder in which
# another one runs takes that one's log away.
entries() {
  find "$build_folder" -name CTestTestfile.cmake -exec cat {} + |
    sed -n 's/^set_tests_properties(\[*=*\[*\([A-Za-z0-9_]*\)[]=]* PROPERTIES \(.*\)$/\1 \2/p' |
    grep -E "LABELS \"([^\"]*;)?$1[;\"]" | cut -d ' ' -f 1 | sort
}

grouped=
while read -r group paths; do
  [[ -n $group && $group != \#* ]] || continue
  for path in $paths; do
    [[ -e $source_folder/$path ]] || complain "tests/nightly.groups: $group depends on $path, which is not there"
  done
  in_build=$(entries "nightly_$group")
  [[ -n $in_build ]] || complain "tests/nightly.groups: no entry has the label nightly_$group"
  on_page=$(grep "^| \`$group\` |" "$page" | cut -d '|' -f 4 | grep -o '`[^`]*`' | tr -d '`' | sort)
  [[ $on_page == "$in_build" ]] ||
    complain "$page, group $group (<: only on the page, >: only labelled):" \
      $'\n'"$(diff <(printf '%s\n' "$on_page") <(printf '%s\n' "$in_build") | grep '^[<>]')"
  grouped+=$in_build$'\n'
done < "$source_folder/tests/nightly.groups"

rest=$(comm -13 <(printf '%s' "$grouped" | sort -u) <(entries nightly))
[[ -z $rest ]] || complain "nightly, and in no group of tests/nightly.groups: $rest"
exit "$failed"
