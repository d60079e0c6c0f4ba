#!/usr/bin/env bash
# results_test.sh SOURCE-FOLDER: what tools/dev/results.sh makes of planted consoles and logs of CTest.
set -uo pipefail
source "$1/tests/workshop/dev/is.sh"
source "$1/tools/dev/results.sh"
source "$1/tools/dev/nightly.sh"
cd "$(mktemp -d)" || exit
trap 'rm -rf "$PWD"' EXIT
# entry NAME VERDICT: what the console says of one entry; its output, from the standard input, goes to the log.
n=0
entry() {
  printf '%d/9 Test #%d: %s ........   %s    0.01 sec\n' $((++n)) "$n" "$1" "$2" >> console
  { printf '%d/9 Testing: %s\nOutput:\n' "$n" "$1" && cat; } >> log
}
fresh() { rm -f console log && n=0 && : > console && : > log; }
read_sorted() { read_results console log | sort; }

# A program whose cases passed, failed with a parameter, and skipped; the one that skipped is not hidden.
fresh
entry program "***Failed" << 'LOG'
[ RUN      ] suite.good
[       OK ] suite.good (0 ms)
[ RUN      ] suite.bad/1
[  FAILED  ] suite.bad/1, where GetParam() = 7 (3 ms)
[ RUN      ] suite.absent
a_test.cpp:9: Skipped
no such device
[  SKIPPED ] suite.absent (0 ms)
[==========] 3 tests from 1 test suite ran. (3 ms total)
[  FAILED  ] 1 test, listed below:
[  FAILED  ] suite.bad/1, where GetParam() = 7
LOG
is "cases" "$(read_sorted)" "$(printf 'failed\tprogram suite.bad/1\t\npassed\tprogram suite.good\t\nskipped\tprogram suite.absent\tno such device')"

# A program that died in its second case, one that ran too long, one that was not started, a script, one that says why
# it did nothing.
fresh
entry died "***Exception: SegFault" << 'LOG'
[ RUN      ] suite.first
[       OK ] suite.first (0 ms)
[ RUN      ] suite.second
LOG
entry slow "***Timeout" < /dev/null
entry gone "***Not Run" < /dev/null
entry script "Passed" <<< "fine"
entry guest "***Skipped" <<< "SKIPPED: no emulator"
is "entries" "$(read_sorted)" "$(printf 'failed\tdied\t\nfailed\tgone\t\nfailed\tslow\t\npassed\tdied suite.first\t\npassed\tscript\t\nskipped\tguest\tno emulator')"

# A verdict that does not stand at the head of its line is not seen: that must not pass for a case less.
fresh
entry muddled "Passed" << 'LOG'
[ RUN      ] suite.first
[       OK ] suite.first (0 ms)
[ RUN      ] suite.second
half a line[       OK ] suite.second (0 ms)
[==========] 2 tests from 1 test suite ran. (0 ms total)
LOG
is "a lost case" "$(read_sorted)" "$(printf 'failed\tmuddled\t2 cases ran, and the log names 1\npassed\tmuddled suite.first\t')"

# Somebody took the log away while the tests ran.
fresh
entry whole "Passed" <<< "fine"
entry lost "Passed" <<< "fine"
sed -i '/Testing: lost/,$d' log
is "a lost log" "$(read_sorted)" "$(printf 'failed\tlost\tit is not in the log of CTest\npassed\twhole\t')"

# A skip's reason is not the next one's.
fresh
entry program "Passed" << 'LOG'
[ RUN      ] suite.one
a_test.cpp:9: Skipped
its own reason
[  SKIPPED ] suite.one (0 ms)
[ RUN      ] suite.two
[  SKIPPED ] suite.two (0 ms)
[==========] 2 tests from 1 test suite ran. (0 ms total)
LOG
is "reasons" "$(read_sorted | cut -f 3)" "$(printf 'its own reason\nno reason given')"

# Several builds: a test counts once, failed where any build says so, skipped where none ran it. A step counts as one.
row() { printf '%s\t%s\t%s\n' "$@"; }
{ row passed a "" && row passed b "" && row skipped c "no GPU" && row skipped d "no bus" && row passed "e one" ""; } > first
{ row passed a "" && row failed b "" && row passed c "" && row skipped d "no bus" && row passed "e two" ""; } > second
{ row passed a "" && row passed b ""; } > third
row passed "step format" "" > step
is "distinct tests" "$(closing_lines first second third step)" "$(printf '1 skipped\n5 passed, 1 failed')"
is "order" "$(closing_lines step third second first)" "$(printf '1 skipped\n5 passed, 1 failed')"
closing_lines first second > /dev/null && is "status of a failure" 0 1
closing_lines first third > /dev/null || is "status of success" 1 0
closing_lines /dev/null > /dev/null && is "status of nothing" 0 1
is "skips" "$(tell_skipped first second third)" "skipped: d: no bus"
is "a build's own count" "$(count_results first)" "3 passed, 0 failed, 2 skipped"
is "a line that is no result" "$(echo rubbish | cat first - > torn && closing_lines torn | tail -n 1)" "3 passed, 1 failed"

# A DISABLED_ case that no program ran.
mkdir -p sources
printf 'TEST(a, DISABLED_one) {}\nTEST_P(b,\n       DISABLED_three) {}\n' > sources/a.cpp
printf 'TYPED_TEST(c, DISABLED_two) {}\nTEST(d, ordinary) {}\n' > sources/b.hpp
row passed "p a.DISABLED_one" "" > ran
{ row passed "p x/c/0.DISABLED_two/3" "" && row failed "p x/b.DISABLED_three/1" ""; } >> ran
is "every disabled case ran" "$(all_ran sources ran && echo yes)" "yes"
sed -i '1d' ran
is "a disabled case did not run" "$(all_ran sources ran)" "DISABLED_one is in sources/, and no program ran it"
all_ran sources ran > /dev/null && is "status of a case that did not run" 0 1

# What a half of the matrix leaves has to fit the status it ended with.
accounts_for 0 < first || is "passed" no yes
accounts_for 1 < second || is "failed" no yes
accounts_for 1 < first && is "ended before it could tell" yes no
accounts_for 0 < second && is "failed, and said to have passed" yes no
accounts_for 0 < /dev/null && is "nothing" yes no
exit "$failed"
