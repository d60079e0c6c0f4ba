#!/usr/bin/env bash
# digest_test.sh SOURCE-FOLDER RECORDING: the golden recording is the one whose digest is kept, and each change of it has an entry
# of its own in CHANGELOG.md (see tools/dev/golden.sh).
set -uo pipefail
source "$1/tools/dev/golden.sh"
digest=$(recording_digest "$2") || exit
if [[ $(golden_platform) != "$golden_kept_for" ]]; then
  # What was kept is still asked about: its seals, and its entries.
  digest=$(grep -v '^#' "$1/tests/session/golden/recording.digests" | tail -n 1 | cut -d ' ' -f 1)
  check_golden "$1/tests/session/golden/recording.digests" "$1/CHANGELOG.md" "$digest" || exit
  echo "SKIPPED: digests are kept for $golden_kept_for, and this is $(golden_platform); entries and seals were checked"
  exit 77
fi
check_golden "$1/tests/session/golden/recording.digests" "$1/CHANGELOG.md" "$digest"
