# shellcheck shell=bash
# What is too long for every change and runs once a day: ./dev nightly. Sourced by ./dev, after check.sh.

# The DISABLED_ cases of every GoogleTest program, with the seed of the day.
nightly_disabled() {
  local status=0
  build release
  GTEST_ALSO_RUN_DISABLED_TESTS=1 GTEST_FILTER='*DISABLED_*' \
    test_preset release disabled -L '^gtest$' --timeout 14400 || status=1
  all_ran tests build/check/disabled.results || status=1
  return "$status"
}

# all_ran FOLDER RESULTS: whether the results have every DISABLED_ case of the sources.
all_ran() {
  local name status=0
  while read -r name; do
    grep -q "[.]$name\\b" "$2" && continue
    printf '%s is in %s/, and no program ran it\n' "$name" "$1"
    status=1
  done < <(disabled_names "$1")
  return "$status"
}

# disabled_names FOLDER: names of the DISABLED_ cases in its sources.
disabled_names() {
  find "$1" \( -name '*.cpp' -o -name '*.hpp' \) -exec cat {} + | tr '\n' ' ' |
    grep -oE 'TEST(_F|_P)?\( *[A-Za-z0-9_]+, *DISABLED_[A-Za-z0-9_]+' | sed 's/.*, *//' | sort -u
}

# Fifty times as many bakes of damaged meshes.
nightly_fuzz() {
  build release hostile_bakes
  ASPERITY_FUZZ_TIMES=50 test_preset release fuzz -R '^hostile_bakes$' --timeout 14400
}

# The paper's experiments in full, each of their statements.
nightly_experiments() {
  build release bin/asperity
  build/release/bin/asperity experiment all -o out/nightly
}

# Six hours of virtual time in one session.
nightly_soak() {
  build release asperity_soak
  build/release/bin/asperity_soak --hours 6
}

# ./dev nightly [STEP...]: all of it, or some of: disabled fuzz experiments soak matrix.
run_nightly() {
  local steps=("$@") step
  [[ $# -gt 0 ]] || steps=(disabled fuzz experiments soak matrix)
  for step in "${steps[@]}"; do
    [[ $step == matrix ]] || declare -F "nightly_$step" > /dev/null || die "nightly has no step \"$step\"; it has: disabled fuzz experiments soak matrix"
  done
  night_seed=${ASPERITY_SEED:-$(date -u +%Y%m%d)}
  say "seed of this night: $night_seed (ASPERITY_SEED=$night_seed ./dev nightly repeats it)"
  export ASPERITY_SEED=$night_seed
  begin_check
  configure release
  for step in "${steps[@]}"; do
    if [[ $step == matrix ]]; then
      export ASPERITY_WHOLE_MATRIX=1
      check_matrix
    else
      check_step "$step" "nightly_$step"
    fi
  done
  local status=0
  check_table || status=1
  closing_lines build/check/*.results || status=1
  return "$status"
}
