# shellcheck shell=bash
# The check matrix: every step runs, even after a failure; a table of results and times comes last. Sourced by ./dev.

check_names=()
check_results=()
check_seconds=()
check_tests=()

# check_step NAME FUNCTION: runs FUNCTION with its output in build/check/NAME.log, and shows the log where it fails.
# build/check/NAME.results receives what its tests came to; a step that runs no tests is one test itself, and so is a
# step that failed without one of its tests (see results.sh).
check_step() {
  local name=$1 function=$2 log=build/check/$1.log results=build/check/$1.results start=$SECONDS status tests=""
  step "check: $name"
  rm -f "$results"
  set +e
  (
    set -e
    "$function"
  ) > "$log" 2>&1
  status=$?
  set -e
  check_names+=("$name")
  check_seconds+=($((SECONDS - start)))
  grep -E '^(skipped|left out): ' "$log" || true
  if [[ -s $results ]]; then
    tests=$(count_results "$results")
    say "$tests"
  fi
  check_tests+=("$tests")
  if [[ $status -eq 0 ]]; then
    check_results+=(passed)
    [[ -n $tests ]] || printf 'passed\tstep %s\t\n' "$name" > "$results"
  else
    check_results+=(FAILED)
    grep -q '^failed' "$results" 2> /dev/null || printf 'failed\tstep %s\t\n' "$name" >> "$results"
    tail -n 100 "$log"
    say "check: $name failed; its whole output is in $log"
  fi
}

# test_preset PRESET STEP [CTEST ARGUMENT...]: runs the tests of a built preset, whose results become the step's.
test_preset() {
  local preset=$1 name=$2 status=0
  shift 2
  run_ctest "$preset" "$@" || status=1
  cp "build/$preset/test-results" "build/check/$name.results"
  return "$status"
}

check_format() {
  git ls-files '*.hpp' '*.h' '*.cpp' | xargs clang-format --dry-run -Werror
}

# Consumers of every kind: each header of the core, of links and of drivers, a program that presses a box onto another and
# one with drivers, without exceptions and without type information, as C++20 and C++23, by both compilers, with the
# warnings that careful people use.
check_consumers() {
  local compiler standard
  local core=build/release/src/libasperity.a links=build/release/hal/transport/libasperity_transport.a
  local drivers=build/release/hal/drivers/libasperity_drivers.a
  local flags=(-fno-exceptions -fno-rtti -O1 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
    -Wold-style-cast -Werror -Iinclude -Ihal/transport/include -Ihal/drivers/include)
  configure release
  build release asperity asperity_drivers
  all_headers include hal/transport/include hal/drivers/include > build/check/headers.cpp
  {
    for compiler in g++ clang++; do
      for standard in c++20 c++2b; do
        printf '%s\n' "$compiler -std=$standard ${flags[*]} -fsyntax-only build/check/headers.cpp"
        printf '%s\n' "$compiler -std=$standard ${flags[*]} tests/system/install/core_consumer.cpp $core \
          -o build/check/consumer-$compiler-$standard && build/check/consumer-$compiler-$standard"
        printf '%s\n' "$compiler -std=$standard ${flags[*]} tests/system/install/hal/drivers.cpp $drivers $links $core \
          -o build/check/drivers-$compiler-$standard && build/check/drivers-$compiler-$standard"
      done
    done
    # The core itself throws nothing either.
    printf "g++ -std=c++20 ${flags[*]} -O0 -Isrc -fsyntax-only %s\n" src/*/*.cpp
  } > build/check/consumers.commands
  at_once < build/check/consumers.commands
}

# Runs the commands of its input, one a line, as many at a time as there are cores. Fails where one did.
at_once() { xargs -d '\n' -P "$(nproc)" -n 1 bash -ec; }

# all_headers FOLDER...: a translation unit that includes every header in these folders.
all_headers() {
  git ls-files "$@" | sed -n 's|^.*include/\(asperity/.*\.h\(pp\)\{0,1\}\)$|#include "\1"|p'
}

# What an optimising compiler of another make could find something in. Clang compiles and runs more with the sanitizers.
core_tests=(unit_core unit_window_force control_test hal_test contract_depth simulation_test)

# whole_matrix PRESET STEP: every test but the long ones and those of an installation, with ASPERITY_WHOLE_MATRIX=1.
whole_matrix() {
  left_out long "they take minutes, and ./dev test has run them"
  left_out install "./dev test has run them"
  build "$1"
  test_preset "$1" "$2" -LE 'long|install'
}

# GCC without optimisation compiles what the header sets and the comparison of bits need. Tests of a Debug build are run
# with the sanitizers, below.
check_gcc_debug() {
  configure debug
  if [[ -n ${ASPERITY_WHOLE_MATRIX:-} ]]; then
    whole_matrix debug gcc-debug
  else
    say "left out: tests, which asan-ubsan runs in a Debug build (ASPERITY_WHOLE_MATRIX=1 ./dev check runs them here too)"
    build debug bin/asperity simulation_digest
  fi
}

# The groups of nightly tests that a change has touched since they last passed. Where ASPERITY_UNTIL says so, in seconds
# since 1970, none is begun later: .ci/run has an end, and who is cut off by it has told nothing. What is left out stays
# due.
check_nightly() {
  local group status=0 groups
  rm -f build/check/nightly.results
  mapfile -t groups < <(nightly_groups)
  for group in "${groups[@]}"; do
    if recorded "$group"; then
      say "left out: nightly tests of the group '$group', whose files are those that passed on $(recorded_on "$group")"
    elif [[ -n ${ASPERITY_UNTIL:-} && $(date +%s) -ge $ASPERITY_UNTIL ]]; then
      say "left out: nightly tests of the group '$group', which are due: no time is left (./dev nightly groups runs them)"
    else
      run_nightly_groups nightly "$group" || status=1
    fi
  done
  return "$status"
}

check_header_sets() { cmake --build build/debug --target all_verify_interface_header_sets; }

check_clang_release() {
  configure clang
  if [[ -n ${ASPERITY_WHOLE_MATRIX:-} ]]; then
    whole_matrix clang clang-release
  else
    say "left out: all tests but a few of the core (ASPERITY_WHOLE_MATRIX=1 ./dev check runs them)"
    build clang bin/asperity bin/asperity-conformance simulation_digest "${core_tests[@]}"
    test_preset clang clang-release -R "^($(IFS='|' && echo "${core_tests[*]}"))$"
  fi
}

# A Debug build, assertions and all. What reads bytes from outside, keeps memory of its own or talks to somebody else's,
# and the core's units. With ASPERITY_WHOLE_MATRIX=1 every test that is not long: a quarter of an hour more.
check_asan_ubsan() {
  local tests=(unit_core unit_core_triple_buffer unit_model unit_io unit_render unit_window_finder unit_window_depth unit_window_force control_test
    real_session_test hal_test simulation_test contract_depth hostile_fuzz hostile_bakes unit_gl gl_compute_depth
    gl_occlusion hal_hid_test hal_can unit_joint_drives hal_falcon unit_arm hal_directory plugin_test) only=()
  configure asan-ubsan
  if [[ -n ${ASPERITY_WHOLE_MATRIX:-} ]]; then
    left_out long "too slow under the address sanitizer"
    left_out install "a consumer's program is not built with sanitizers"
    build asan-ubsan
  else
    say "left out: tests that are long or of other rooms (ASPERITY_WHOLE_MATRIX=1 ./dev check runs the latter)"
    build asan-ubsan "${tests[@]}"
    only=(-R "^($(IFS='|' && echo "${tests[*]}"))$")
  fi
  export LSAN_OPTIONS=suppressions=$PWD/tools/dev/leaks.supp:print_suppressions=0
  test_preset asan-ubsan asan-ubsan -LE 'long|install' "${only[@]}"
}

# ThreadSanitizer sees only what runs in two threads at once; everything else is covered by the other builds.
# A test's program has the name of its CTest entry, so the entries labelled `threads` are also the targets to build.
check_tsan() {
  local targets
  configure tsan
  mapfile -t targets < <(ctest --test-dir build/tsan -N -L threads | sed -n 's/^ *Test *#[0-9]*: //p')
  build tsan "${targets[@]}"
  test_preset tsan tsan -L threads
}

left_out() { say "left out: tests labelled '$1' ($2)"; }

# The compiled rooms by their compile commands, several sources at a time as they are built, and one translation unit that
# shows it every header of the core. Its count of warnings in system headers says nothing about this project and is
# dropped. A build folder of its own, which is never built: without precompiled headers each file is read as it stands, and
# what a build would write there, the page's files as strings, is left out.
check_tidy() {
  cmake --preset clang -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON > build/tidy.configure.log 2>&1 ||
    { cat build/tidy.configure.log && return 1; }
  all_headers include > build/check/core.cpp
  {
    local status=0
    sed -n 's|^ *"file": "\(.*\)",\{0,1\}$|\1|p' build/tidy/compile_commands.json |
      grep -E "^$PWD/(build/tidy/)?(tools|examples|backends|hal)/" | grep -v -e verify_interface -e /page_files.cpp -e /panel_files.cpp > build/check/tidy.sources
    [[ -s build/check/tidy.sources ]] || { say "no sources were found to read" && status=1; }
    {
      say "clang-tidy --quiet build/check/core.cpp -- -std=c++20 -Iinclude"
      sed 's|.*|clang-tidy --quiet -p build/tidy --checks=-bugprone-suspicious-include "&"|' build/check/tidy.sources
    } | at_once || status=1
    exit "$status"
  } 2>&1 | sed '/^[0-9]* warnings\{0,1\} generated\.$/d'
}

# The same session, and 50 simulated ones, bit for bit, whoever compiled them.
check_determinism() {
  local build builds=(release debug clang)
  for build in "${builds[@]}"; do configure_and_build "$build" bin/asperity simulation_digest; done
  # Without optimisation both take long, and come first.
  for build in debug release clang; do
    rm -rf "build/check/$build"
    mkdir -p "build/check/$build"
    printf '%s\n' "build/$build/tests/session/simulation/simulation_digest > build/check/$build/simulation.txt"
    printf '%s\n' "tests/session/golden/session.sh build/$build/bin/asperity build/check/$build"
  done | at_once
  for build in "${builds[@]}"; do
    mv "build/check/$build/simulation.txt" "build/check/$build/golden/"
    (cd "build/check/$build/golden" && sha256sum -- *) > "build/check/$build.sha256"
    say "$build:"
    cat "build/check/$build.sha256"
  done
  cmp build/check/release.sha256 build/check/debug.sha256
  cmp build/check/release.sha256 build/check/clang.sha256
}

begin_check() {
  setup
  mkdir -p build/check
  rm -f build/check/*.results
}

check_matrix() {
  check_step format check_format
  check_step consumers check_consumers
  check_step gcc-debug check_gcc_debug
  check_step header-sets check_header_sets
  check_step clang-release check_clang_release
  check_step clang-tidy check_tidy
  check_step asan-ubsan check_asan_ubsan
  check_step tsan check_tsan
  check_step determinism check_determinism
  check_step nightly check_nightly  # last: what is due may take longer than all the others together
}

run_check() {
  begin_check
  check_matrix
  check_table
}

check_table() {
  local i failed=0
  printf '\n%-16s %-7s %7s  %s\n' step result time tests
  for i in "${!check_names[@]}"; do
    printf '%-16s %-7s %5d s  %s\n' "${check_names[i]}" "${check_results[i]}" "${check_seconds[i]}" "${check_tests[i]}"
    [[ ${check_results[i]} == passed ]] || failed=$((failed + 1))
  done
  say
  if [[ $failed -gt 0 ]]; then
    say "check: $failed of ${#check_names[@]} steps failed"
    return 1
  fi
  say "check: all ${#check_names[@]} steps passed"
}
