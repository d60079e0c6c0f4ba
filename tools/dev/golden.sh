# shellcheck shell=bash
# The golden recording's digest and the changelog: what a user feels does not change without a word. Sourced by ./dev and
# by tests/session/golden.
#
# tests/session/golden/recording.digests has one line per form that the recording had, the newest last: digest, seal, and words
# that one entry of CHANGELOG.md has, marked [force]. The seal binds the words to the digest, so that a digest replaced by
# hand is seen. A line with - for a digest takes an entry that was there before the first digest was kept. Nothing here asks git: it holds in a shallow clone and in an unpacked archive alike.

# Columns of a recording that are motion and wrench. Others may come and go without a change of what is felt.
golden_columns="time_s device_[xyzq].* probe_[xyzq].* contact_[ft][xyz]_.* hand_[ft][xyz]_.*"

# recording_digest CSV: SHA-256 of those columns, with their names.
recording_digest() (
  set -o pipefail
  awk -F, -v OFS=, -v wanted="^(${golden_columns// /|})$" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ wanted) keep[++n] = i }
    { line = $keep[1]; for (i = 2; i <= n; i++) line = line OFS $keep[i]; print line }
    END { if (n != 27) { print "golden: " n + 0 " columns of motion and wrench, not 27" > "/dev/stderr"; exit 1 } }
  ' "$1" | sha256sum | cut -d ' ' -f 1
)

# force_entries CHANGELOG [unreleased]: its entries that are marked [force], one a line; with `unreleased`, only those.
force_entries() {
  awk -v only="${2:-}" '
    function flush() { if (entry ~ /\[force\]/ && (only == "" || section ~ /^## \[Unreleased\]/)) print entry; entry = "" }
    /^#/  { flush() }
    /^## / { section = $0 }
    /^- / { flush(); entry = substr($0, 3); next }
    /^$/  { flush() }
    entry != "" { sub(/^ +/, ""); entry = entry " " $0 }
    END { flush() }
  ' "$1"
}

golden_seal() { printf '%s %s' "$1" "$2" | sha256sum | cut -c 1-12; }

# golden_platform: the machine whose digest is kept. Another libm rounds sines and logarithms otherwise, by as little as
# the last bit, and so does this one on a processor without fused multiply-add.
golden_platform() {
  local fma=""
  grep -qw fma /proc/cpuinfo 2> /dev/null && fma=" fma"
  printf '%s %s%s\n' "$(uname -m)" "$(getconf GNU_LIBC_VERSION 2> /dev/null)" "$fma"
}
golden_kept_for="x86_64 glibc 2.36 fma"

# check_golden DIGESTS CHANGELOG DIGEST: whether the newest line is of this digest, and each line has an entry of its own.
check_golden() {
  local digest seal words entry newest="" status=0 used=()
  while read -r digest seal words; do
    [[ $digest != "#"* ]] || continue
    [[ $digest == - ]] || newest=$digest
    [[ $seal == "$(golden_seal "$digest" "$words")" ]] ||
      { status=1 && printf '%s: the line "%.12s... %s" was edited by hand; ./dev golden adds lines\n' "$1" "$digest" "$words"; }
    entry=$(force_entries "$2" | grep -F -- "$words" || true)
    if [[ -z $words || -z $entry || $entry == *$'\n'* ]]; then
      status=1
      printf '%s: not one entry, marked [force], has the words "%s" of %s\n' "$2" "$words" "$1"
    elif printf '%s\n' "${used[@]}" | grep -qxF -- "$entry"; then
      status=1
      printf '%s: two lines came with the same entry of %s: "%s"\n' "$1" "$2" "$words"
    fi
    used+=("$entry")
  done < "$1"
  if [[ $newest != "$3" ]]; then
    status=1
    printf '%s\n' "The golden session feels otherwise: its recording has the digest" "  $3" "and the newest one in $1 is" \
      "  ${newest:-none}" "If that was meant: write an entry, marked [force], under Unreleased in CHANGELOG.md, that says what a user" \
      "feels differently. Then run ./dev golden 'some words of that entry', and commit both files." \
      "If it was not meant, the change has to be found: git bisect with ./dev golden --show."
  fi
  return "$status"
}

# add_golden DIGESTS CHANGELOG DIGEST WORDS: adds a line, where an unreleased entry with these words is free for it.
add_golden() {
  local entry kept
  entry=$(force_entries "$2" unreleased | grep -F -- "$4" || true)
  [[ -n $4 && -n $entry && $entry != *$'\n'* ]] || {
    printf '%s: not one entry under Unreleased, marked [force], has the words "%s"; entries to choose from:\n' "$2" "$4"
    force_entries "$2" unreleased | cut -c 1-100 | sed 's/^/  /'
    return 1
  }
  kept=$(cat "$1")
  printf '%s %s %s\n' "$3" "$(golden_seal "$3" "$4")" "$4" >> "$1"
  check_golden "$1" "$2" "$3" || { printf '%s\n' "$kept" > "$1" && return 1; }
}

# ./dev golden WORDS: runs the golden session and adds its digest. ./dev golden --show: prints the digest only.
run_golden() {
  local digests=tests/session/golden/recording.digests digest
  [[ $# -eq 1 ]] || die "golden needs words of the new entry, marked [force], in CHANGELOG.md; or --show"
  setup
  configure_and_build release bin/asperity
  tests/session/golden/session.sh build/release/bin/asperity build/golden
  digest=$(recording_digest build/golden/golden/recording.csv)
  say "$digest"
  [[ $1 != --show ]] || return 0
  [[ $(golden_platform) == "$golden_kept_for" ]] ||
    die "digests are kept for $golden_kept_for, and this is $(golden_platform)"
  if [[ $(grep -v '^#' "$digests" | tail -n 1) == "$digest "* ]]; then
    say "$digests has it already"
  else
    add_golden "$digests" CHANGELOG.md "$digest" "$1" || die "nothing was added"
    say "added to $digests"
  fi
}
