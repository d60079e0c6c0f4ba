# shellcheck shell=bash
# Building and testing one preset. Sourced by ./dev.

# ccache keeps what was compiled with precompiled headers only where it need not look for macros in them.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
# The compiler's own list of headers tells what a result depends on: no run of the preprocessor before it for that.
export CCACHE_DEPEND=${CCACHE_DEPEND:-1}

configure() {
  local preset=$1 launcher=()
  command -v ccache > /dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  mkdir -p build
  cmake --preset "$preset" "${launcher[@]}" > "build/$preset.configure.log" 2>&1 || {
    cat "build/$preset.configure.log" >&2
    die "configuring the preset $preset failed; its output is above and in build/$preset.configure.log"
  }
}

# build PRESET [TARGET...]
build() {
  local preset=$1
  shift
  step "build ($preset)"
  # Ninja would start two more compilers than there are cores: on two cores that takes a twentieth longer.
  cmake --build "build/$preset" -j "$(nproc)" ${1:+--target "$@"}
}

# configure_and_build PRESET [TARGET...]
configure_and_build() {
  configure "$1"
  build "$@"
}

# run_ctest PRESET [CTEST ARGUMENT...]: runs the tests of a built preset, says which were skipped and why, and leaves
# "N passed, N failed, N skipped" in build/PRESET/test-summary. Fails where a test failed or none was found.
run_ctest() {
  local preset=$1 status=0 console=build/$1/ctest.console log=build/$1/Testing/Temporary/LastTest.log
  shift
  rm -f "$log"
  ctest --test-dir "build/$preset" -j "$(nproc)" --output-on-failure --no-tests=error "$@" 2>&1 |
    tee "$console" || status=1
  touch "$log"
  count_tests "$console" "$log" > "build/$preset/test-counts"
  grep '^skipped: ' "build/$preset/test-counts" || true
  tail -n 1 "build/$preset/test-counts" > "build/$preset/test-summary"
  return "$status"
}

# Counts test cases from CTest's console output (the verdict of each entry) and its log (the cases inside). A GoogleTest
# program counts case by case, so that a case that skipped itself is not hidden by its neighbours; a program that died
# before its own summary counts as one failure, and any other entry as one test.
# Prints "skipped: NAME: REASON" per skipped case, and the totals last.
count_tests() {
  awk '
    function skipped_case(what) {
      skipped++
      print "skipped: " what ": " (reason == "" ? "no reason given" : reason)
      reason = ""
    }
    # First file: "1/9 Test #1: NAME ....   Passed", "***Failed", "***Skipped", "***Not Run", "***Timeout", ...
    NR == FNR {
      if ($0 ~ /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: /) {
        entry = $0
        sub(/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: /, "", entry)
        sub(/ .*/, "", entry)
        verdict[entry] = /   Passed / ? "passed" : /\*\*\*Skipped/ ? "skipped" : "failed"
      }
      next
    }
    # Second file: the output of one entry after the other.
    /^[0-9]+\/[0-9]+ Testing: /             { name = $3; reason = "" }
    /^SKIPPED: /                            { reason = substr($0, 10); why[name] = reason }
    take_reason                             { reason = $0; take_reason = 0 }
    /: Skipped$/                            { take_reason = 1 }
    /^\[       OK \] [^ ]+.* \([0-9]+ ms\)/ { passed++ }
    /^\[  FAILED  \] [^ ]+.* \([0-9]+ ms\)/ { failed++; bad[name]++ }
    /^\[  SKIPPED \] [^ ]+.* \([0-9]+ ms\)/ { skipped_case(name ", " $4) }
    /^\[==========\] .* ran\. /             { counted[name] = 1 }
    END {
      for (name in verdict) {
        if (verdict[name] == "failed") failed += bad[name] ? 0 : 1
        else if (counted[name]) continue
        else if (verdict[name] == "skipped") { reason = why[name]; skipped_case(name) }
        else passed++
      }
      printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped
    }
  ' "$1" "$2"
}
