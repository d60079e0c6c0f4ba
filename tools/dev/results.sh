# shellcheck shell=bash
# What each test came to, and how many distinct tests that is over several builds. Sourced by ./dev and .ci/run.
#
# A file of results has one line per test: VERDICT <tab> TEST <tab> REASON. VERDICT is passed, failed or skipped; TEST is
# the CTest entry, and for a GoogleTest program "ENTRY CASE"; REASON says why one was skipped.

# read_results CONSOLE LOG: results from CTest's console output (the verdict of each entry) and its log (the cases
# inside). A GoogleTest program is read case by case, so that a case that skipped itself is not hidden by its neighbours.
# A program that failed without a failed case (it died, or ran too long) is one failed test, and so is one whose log
# does not name as many cases as it says it ran, and an entry that passed and is not in the log: a case that cannot be
# seen must not count as none.
read_results() {
  awk '
    function tell(verdict, what, why) { printf "%s\t%s\t%s\n", verdict, what, why }
    # First file: "1/9 Test #1: NAME ....   Passed", "***Failed", "***Skipped", "***Not Run", "***Timeout", ...
    FILENAME == ARGV[1] {
      if ($0 ~ /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: /) {
        entry = $0
        sub(/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: /, "", entry)
        sub(/ .*/, "", entry)
        verdict[entry] = /   Passed / ? "passed" : /\*\*\*Skipped/ ? "skipped" : "failed"
      }
      next
    }
    # Second file: the output of one entry after the other.
    /^[0-9]+\/[0-9]+ Testing: /             { name = $3; reason = ""; logged[name] = 1 }
    /^SKIPPED: /                            { reason = substr($0, 10); why[name] = reason }
    take_reason                             { reason = $0; take_reason = 0 }
    /: Skipped$/                            { take_reason = 1 }
    /^\[ RUN      \] /                      { reason = "" }
    /^\[       OK \] [^ ]+.* \([0-9]+ ms\)/ { told[name]++; tell("passed", name " " $4, "") }
    /^\[  FAILED  \] [^ ]+.* \([0-9]+ ms\)/ { told[name]++; bad[name]++; sub(/,$/, "", $4); tell("failed", name " " $4, "") }
    /^\[  SKIPPED \] [^ ]+.* \([0-9]+ ms\)/ { told[name]++; tell("skipped", name " " $4, reason == "" ? "no reason given" : reason) }
    /^\[==========\] [0-9]+ tests? .* ran\. / { counted[name] = 1; ran[name] += $2 }
    END {
      for (name in verdict) {
        if (verdict[name] == "failed" && !bad[name]) tell("failed", name, "")
        else if (verdict[name] == "passed" && !logged[name]) tell("failed", name, "it is not in the log of CTest")
        else if (told[name] < ran[name]) tell("failed", name, ran[name] " cases ran, and the log names " told[name] + 0)
        else if (counted[name] || verdict[name] == "failed") continue
        else if (verdict[name] == "skipped") tell("skipped", name, name in why ? why[name] : "no reason given")
        else tell("passed", name, "")
      }
    }
  ' "$1" "$2"
}

# merge_results FILE...: one line per distinct test. What failed anywhere has failed; what passed anywhere else has
# passed; skipped is what ran nowhere.
merge_results() {
  awk -F '\t' -v OFS='\t' '
    BEGIN { weight["skipped"] = 1; weight["passed"] = 2; weight["failed"] = 3 }
    !($1 in weight) { $0 = "failed\tresults: " FILENAME " has a line that is no result" }
    !($2 in verdict) { order[++tests] = $2 }
    weight[$1] > weight[verdict[$2]] { verdict[$2] = $1; reason[$2] = $3 }
    END { for (i = 1; i <= tests; i++) print verdict[order[i]], order[i], reason[order[i]] }
  ' "$@"
}

# count_results FILE...: "N passed, N failed, N skipped", each distinct test once.
count_results() {
  merge_results "$@" | awk -F '\t' '
    { n[$1]++ }
    END { printf "%d passed, %d failed, %d skipped\n", n["passed"], n["failed"], n["skipped"] }'
}

# tell_skipped FILE...: "skipped: TEST: REASON" for each distinct test that ran nowhere.
tell_skipped() { merge_results "$@" | awk -F '\t' '$1 == "skipped" { print "skipped: " $2 ": " $3 }'; }

# closing_lines FILE...: "N skipped", and "N passed, N failed" alone on the last line. Fails where a test failed, or
# where there is none.
closing_lines() {
  merge_results "$@" | awk -F '\t' '
    { n[$1]++ }
    END {
      printf "%d skipped\n%d passed, %d failed\n", n["skipped"], n["passed"], n["failed"]
      exit n["failed"] > 0 || n["passed"] == 0
    }'
}

# accounts_for STATUS: whether the results on the standard input are what a run leaves that ended with that status:
# some, and a failed one where it is not 0.
accounts_for() {
  awk -F '\t' -v status="$1" '{ n[$1]++ } END { exit !(NR > 0 && (status == 0) == !n["failed"]) }'
}
