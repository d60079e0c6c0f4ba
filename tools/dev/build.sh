# shellcheck shell=bash
# Building and testing one preset. Sourced by ./dev.

# ccache keeps what was compiled with precompiled headers only where it need not look for macros in them.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
# The compiler's own list of headers tells what a result depends on: no run of the preprocessor before it for that.
export CCACHE_DEPEND=${CCACHE_DEPEND:-1}

# configure PRESET [CMAKE ARGUMENT...]
configure() {
  local preset=$1 launcher=()
  command -v ccache > /dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  mkdir -p build
  cmake --preset "$preset" "${launcher[@]}" "${@:2}" > "build/$preset.configure.log" 2>&1 || {
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
# what each came to in build/PRESET/test-results and their numbers in build/PRESET/test-summary (see results.sh). Fails
# where a test failed or none was found.
run_ctest() {
  local preset=$1 status=0 console=build/$1/ctest.console log=build/$1/Testing/Temporary/LastTest.log
  local results=build/$1/test-results
  shift
  rm -f "$log" "$results"
  ctest --test-dir "build/$preset" -j "$(nproc)" --output-on-failure --no-tests=error "$@" 2>&1 |
    tee "$console" || status=1
  touch "$log"
  read_results "$console" "$log" > "$results"
  tell_skipped "$results"
  count_results "$results" > "build/$preset/test-summary"
  # What the results take for a failure is one, whatever CTest thought of it.
  ! grep -q '^failed' "$results" || status=1
  return "$status"
}
