#!/usr/bin/env bash
# udev_rules.sh RULES: does udev take every line of a rules file? Exit 77: it cannot be asked here.
# udev says what it does not understand and goes on with the next line. A line that is wrong on purpose shows that it does.
set -euo pipefail
rules=$1

skip() {
  echo "skipped: $*"
  exit 77
}

command -v udevadm > /dev/null || skip "there is no udevadm (Debian: udev)"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cp "$rules" "$scratch/70-asperity.rules"
echo 'SUBSYSTEM=="hidraw", KERNELZ=="*:046D:C626.*", TAG+="uaccess"' > "$scratch/71-wrong.rules"

if udevadm verify --version > /dev/null 2>&1; then
  udevadm verify "$scratch/70-asperity.rules" || exit 1
  ! udevadm verify "$scratch/71-wrong.rules" > /dev/null 2>&1 || { echo "a wrong line went unnoticed"; exit 1; }
  echo "udevadm verify takes every line"
  exit 0
fi

# Before systemd 254: `udevadm test` reads the system's folders, so ours is laid over one of them for this process only.
[[ $(id -u) -eq 0 ]] || skip "udevadm has no 'verify' here, and only root can lay a folder over /run"
unshare -m true 2> /dev/null || skip "udevadm has no 'verify' here, and this process may not unshare its mounts"
said=$(unshare -m bash -c '
  mount -t tmpfs rules /run && mkdir -p /run/udev/rules.d && cp "$1"/*.rules /run/udev/rules.d/ &&
  udevadm test --action=add /sys/class/net/lo 2>&1' - "$scratch" || true)
grep -q 'Reading rules file: /run/udev/rules.d/70-asperity.rules' <<< "$said" || skip "udevadm test read no rules here"
grep -q '71-wrong.rules:1' <<< "$said" || { echo "a wrong line went unnoticed"; exit 1; }
if grep '70-asperity.rules:[0-9]' <<< "$said"; then exit 1; fi
echo "udevadm test takes every line"
