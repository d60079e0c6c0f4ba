#!/usr/bin/env bash
# nightly_test.sh SOURCE-FOLDER: which groups of nightly tests ./dev check runs, and which it notes as passed, in a
# repository made for this, with results that are planted.
set -uo pipefail
source "$1/tests/workshop/dev/is.sh"
source "$1/tools/dev/results.sh"
source "$1/tools/dev/check.sh"
source "$1/tools/dev/nightly.sh"
cd "$(mktemp -d)" || exit
trap 'rm -rf "$PWD"' EXIT
# In place of ./dev and of builds: run_ctest notes the group it was asked for, and leaves what is planted for it.
say() { printf '%s\n' "$*"; }
step() { :; }
die() { say "$*" && exit 1; }
configure() { :; }
build() { :; }
run_ctest() {
  local group=${3#^nightly_}
  group=${group%\$}
  printf '%s ' "$group" >> ran
  cp "planted.$group" build/release/test-results
  [[ -z ${edited_meanwhile:-} ]] || echo 4 >> gate/a.hpp
  ! grep -q '^failed' build/release/test-results
}
# ran: the groups that a check runs, and whether it passed.
ran() {
  : > ran
  local verdict=passed
  check_nightly > said || verdict=failed
  printf '%s%s' "$(cat ran)" "$verdict"
}

mkdir -p build/release build/check tests/support law gate tools/cmake
printf 'build\nran\nsaid\nplanted.*\n' > .gitignore
touch CMakeLists.txt CMakePresets.json tests/CMakeLists.txt tests/support/a.hpp tools/cmake/a law/a.cpp gate/a.hpp
printf '# groups\nlaw   law gate\ngate  gate\n' > tests/nightly.groups
git init -q . && git add -A
printf 'passed\tx\t\n' | tee planted.law > planted.gate

is "everything where nothing is recorded" "$(ran)" "law gate passed"
is "the record" "$(cut -d ' ' -f 1,3 tests/nightly.passed)" "$(printf 'gate %s\nlaw %s' "$(date -u +%Y-%m-%d)" "$(date -u +%Y-%m-%d)")"
is "nothing where nothing has changed" "$(ran)" "passed"
is "what is left out is said" "$(grep -c '^left out: nightly tests of the group' said)" 2

echo 1 >> law/a.cpp
is "the group whose file has changed" "$(ran)" "law passed"
echo 1 > law/new.cpp
is "the group that has a new file" "$(ran)" "law passed"
git rm -qf law/a.cpp
is "the group that has lost a file" "$(ran)" "law passed"
mv law/new.cpp law/named.cpp
is "the group whose file has another name" "$(ran)" "law passed"
echo 1 >> tests/support/a.hpp
is "all groups, for a file that all depend on" "$(ran)" "law gate passed"
is "nothing after that" "$(ran)" "passed"

# A file that is edited while the tests run was not tested.
echo 3 >> gate/a.hpp
edited_meanwhile=1
is "before the edit" "$(ran)" "law gate passed"
edited_meanwhile=
is "after the edit" "$(ran)" "law gate passed"
is "nothing after that either" "$(ran)" "passed"

# A failure and a skip are not recorded: the group runs again.
echo 2 >> gate/a.hpp
printf 'passed\tx\t\nfailed\ty\t\n' > planted.gate
is "a failure" "$(ran)" "law gate failed"
is "after a failure" "$(ran)" "gate failed"
printf 'passed\tx\t\nskipped\ty\tno emulator\n' > planted.gate
is "a skip" "$(ran)" "gate passed"
is "after a skip" "$(ran)" "gate passed"
: > planted.gate
is "no results" "$(ran)" "gate passed"
is "after no results" "$(ran)" "gate passed"
printf 'passed\tx\t\n' > planted.gate
is "at last" "$(ran)" "gate passed"
is "after that" "$(ran)" "passed"

# None is begun when the time is over; what was due stays due.
echo 5 >> gate/a.hpp
export ASPERITY_UNTIL=$(($(date +%s) - 1))
is "no time" "$(ran)" "passed"
is "what there was no time for is said" "$(grep -c 'which are due: no time is left' said)" 2
ASPERITY_UNTIL=$(($(date +%s) + 3600))
is "time enough" "$(ran)" "law gate passed"
unset ASPERITY_UNTIL

# The night runs all, whatever is recorded.
: > ran
nightly_groups_of_tests > /dev/null
is "the night" "$(cat ran)" "law gate "

exit "$failed"
