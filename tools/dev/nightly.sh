# shellcheck shell=bash
# What is too long for every change: ./dev nightly runs all of it. Groups of tests that take minutes and show the same as
# long as the files they depend on are the same also run in .ci/run, where one of these files has changed. Sourced by
# ./dev, after check.sh.

nightly_table=tests/nightly.groups
nightly_record=tests/nightly.passed

# nightly_groups: the groups of tests/nightly.groups, one in a line.
nightly_groups() { awk '!/^#/ && NF { print $1 }' "$nightly_table"; }

# group_digest GROUP: a digest of every file that a group depends on, as it stands, and of the names of these files.
group_digest() {
  local group=$1 paths
  read -ra paths < <(awk -v group="$group" '$1 == group { $1 = ""; print }' "$nightly_table")
  [[ ${#paths[@]} -gt 0 ]] || die "$nightly_table has no group \"$group\""
  paths+=(CMakeLists.txt CMakePresets.json tests/CMakeLists.txt tests/support tools/cmake)
  git ls-files -z --cached --others --exclude-standard -- "${paths[@]}" | sort -zu |
    while IFS= read -rd '' file; do [[ ! -e $file ]] || printf '%s\0' "$file"; done |
    xargs -0 sha256sum | sha256sum | cut -d ' ' -f 1
}

# recorded GROUP: whether the group has passed with the files that are here. recorded_on GROUP: when that was.
recorded() { grep -qs "^$1 $(group_digest "$1") " "$nightly_record"; }
recorded_on() { awk -v group="$1" '$1 == group { print $3 }' "$nightly_record"; }

# record GROUP DIGEST: notes that the group has passed with the files of that digest.
record() {
  local line others
  line="$1 $2 $(date -u +%Y-%m-%d)"
  others=$(grep -sv "^$1 " "$nightly_record" || true)
  printf '%s\n' ${others:+"$others"} "$line" | LC_ALL=C sort > "$nightly_record.new"
  mv "$nightly_record.new" "$nightly_record"
}

# complete RESULTS: whether the results of a group are those of a group that has passed: some, none failed, and none
# skipped, which would show less than another machine may ask for.
complete() { awk -F '\t' '{ n[$1]++ } END { exit !(n["passed"] > 0 && n["passed"] == NR) }' "$1"; }

# run_nightly_groups STEP GROUP...: builds and runs groups, notes those that passed, leaves the results of all as the
# step's.
run_nightly_groups() {
  local name=$1 group status=0
  local -A digests
  shift
  # What passes is what was built, even where somebody edits files meanwhile.
  for group in "$@"; do digests[$group]=$(group_digest "$group"); done
  configure release
  build release all asperity_nightly_programs asperity_soak || return
  for group in "$@"; do
    step "nightly tests: $group"
    run_ctest release -L "^nightly_$group\$" || status=1
    cat build/release/test-results >> "build/check/$name.results"
    if complete build/release/test-results; then record "$group" "${digests[$group]}"; fi
  done
  return "$status"
}

# Every group, whatever has changed: many of their tests draw anew each day.
nightly_groups_of_tests() {
  local groups
  mapfile -t groups < <(nightly_groups)
  run_nightly_groups groups "${groups[@]}"
}

# The DISABLED_ cases of every GoogleTest program, with the seed of the day.
nightly_disabled() {
  local status=0
  build release all asperity_nightly_programs
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

# ./dev nightly [STEP...]: all of it, or some of its steps.
run_nightly() {
  local steps=("$@") all=(groups disabled fuzz experiments soak matrix) step
  [[ $# -gt 0 ]] || steps=("${all[@]}")
  for step in "${steps[@]}"; do
    [[ " ${all[*]} " == *" $step "* ]] || die "nightly has no step \"$step\"; it has: ${all[*]}"
  done
  night_seed=${ASPERITY_SEED:-$(date -u +%Y%m%d)}
  say "seed of this night: $night_seed (ASPERITY_SEED=$night_seed ./dev nightly repeats it)"
  export ASPERITY_SEED=$night_seed
  begin_check
  configure release
  for step in "${steps[@]}"; do
    case $step in
      matrix) ASPERITY_WHOLE_MATRIX=1 check_matrix ;;
      groups) check_step groups nightly_groups_of_tests ;;
      *) check_step "$step" "nightly_$step" ;;
    esac
  done
  local status=0
  check_table || status=1
  closing_lines build/check/*.results || status=1
  return "$status"
}
