#!/usr/bin/env bash
# golden_test.sh SOURCE-FOLDER: what tools/dev/golden.sh makes of planted recordings, digests and changelogs.
set -uo pipefail
source "$1/tools/dev/golden.sh"
cd "$(mktemp -d)" || exit
trap 'rm -rf "$PWD"' EXIT
failed=0
fault() { printf 'golden_test: %s\n%s\n' "$1" "$(cat said)" && failed=1; }
accepts() { local what=$1 && shift && "$@" > said 2>&1 || fault "refused: $what"; }
refuses() {  # refuses WHAT WORDS COMMAND...: it fails, and says why
  local what=$1 words=$2
  shift 2
  if "$@" > said 2>&1; then fault "accepted: $what"; fi
  grep -qF -- "$words" said || fault "$what: not said: $words"
}

# A recording: a column of motion or wrench counts, others do not.
awk 'BEGIN {
  n = split("time_s device_x_m device_y_m device_z_m device_qx device_qy device_qz device_qw", c, " ")
  for (i = 2; i <= 8; i++) { c[++n] = c[i]; sub(/device/, "probe", c[n]) }
  for (i = 0; i < 2; i++) for (j = 0; j < 6; j++)
    c[++n] = (i ? "hand_" : "contact_") substr("fffttt", j + 1, 1) substr("xyzxyz", j + 1, 1) (j < 3 ? "_n" : "_n_m")
  for (i = 1; i <= n; i++) printf "%s,", c[i]
  print "contacts,fault"
  for (i = 1; i <= n; i++) printf "%d,", i
  print "3,none"
}' > recording.csv
as_it_is=$(recording_digest recording.csv)
changed() { sed "$1" recording.csv > other.csv && recording_digest other.csv 2> said; }
for ((i = 1; i <= 27; ++i)); do
  [[ $(changed "2s/[^,]*,/9$i,/$i") != "$as_it_is" ]] || fault "a change in column $i is not seen"
done
[[ $(changed '2s/3,none/4,stale/') == "$as_it_is" ]] || fault "a column that is neither motion nor wrench counts"
[[ $(changed 's/$/,more/') == "$as_it_is" ]] || fault "a new column counts"
[[ $(changed '1s/hand_tz_n_m/hand_twist/') == "" || -s said ]] || fault "a column that is gone is not told"
recording_digest /dev/null > said 2>&1 && fault "a recording of nothing has a digest"

changelog() {
  cat << 'TEXT'
# Changelog
Entries that change the wrench are marked [force].
## [Unreleased]
- A door that squeaks.
- The hand is
  pushed less. [force]
- The spring is stiffer. [force]
TEXT
  cat
}
changelog > log.md << 'TEXT'
- A third one, of today. [force]

## [0.1.0]
- Of long ago. [force]
TEXT
[[ $(force_entries log.md | wc -l) == 4 && $(force_entries log.md unreleased | wc -l) == 3 ]] || fault "entries are miscounted"

echo "# header" > digests
accepts "a first line" add_golden digests log.md aaa "is pushed less"
accepts "what was added" check_golden digests log.md aaa
refuses "another recording" "./dev golden 'some words" check_golden digests log.md bbb
refuses "an entry without [force]" "not one entry" add_golden digests log.md bbb "squeaks"
refuses "an entry that was released" "not one entry" add_golden digests log.md bbb "long ago"
refuses "words of several entries" "not one entry" add_golden digests log.md bbb "is"
refuses "no words" "not one entry" add_golden digests log.md bbb ""
refuses "an entry that an earlier line came with" "two lines came with the same entry" add_golden digests log.md bbb "hand is pushed"
accepts "nothing was added by all that" check_golden digests log.md aaa
accepts "a second line" add_golden digests log.md bbb "spring is stiffer"
refuses "the earlier recording" "feels otherwise" check_golden digests log.md aaa

sed 's/^bbb/ccc/' digests > forged
refuses "a digest replaced by hand" "edited by hand" check_golden forged log.md ccc
sed 's/spring is stiffer/third one/' digests > forged
refuses "words replaced by hand" "edited by hand" check_golden forged log.md bbb
grep -v stiffer log.md > shorter.md
refuses "an entry that is gone" "not one entry" check_golden digests shorter.md bbb
sed 's/stiffer. \[force\]/stiffer./' log.md > unmarked.md
refuses "an entry that is no longer marked" "not one entry" check_golden digests unmarked.md bbb
refuses "no line at all" "none" check_golden <(echo "# header") log.md aaa
sed 's/^## \[Unreleased\]/## [0.2.0]/' log.md > released.md
accepts "entries that were released since" check_golden digests released.md bbb
exit "$failed"
