#!/usr/bin/env bash
# Runs test programs one after the other as root of a machine of their own: a stock Debian kernel in an emulator, booted
# for this and thrown away. Nothing of the host is seen or changed in there.
#
#   guest.sh CACHE PROGRAM...
#
# CACHE keeps the kernel between runs (some 95 MB; fetched once, 71 MB). ASPERITY_GUEST_MODULES, ASPERITY_GUEST_MEMORY_MB
# and ASPERITY_GUEST_SECONDS change the modules, the memory and the limit in time.
# Exit status: 0 all passed, 1 a program failed or the machine died, 77 it could not be made here: the last line says why.
set -euo pipefail

[[ $# -ge 2 ]] || { echo "usage: guest.sh CACHE PROGRAM..." >&2 && exit 1; }
cache=$1
shift
# The tests' devices: virtual CAN and an emulated PCI card with two ports, a serial line that is a CAN adapter, HID and USB
# devices that the test program itself is.
modules=${ASPERITY_GUEST_MODULES:-virtio_pci vcan can-raw kvaser_pci slcan uhid hid-generic vhci-hcd}
memory_mb=${ASPERITY_GUEST_MEMORY_MB:-768}
seconds=${ASPERITY_GUEST_SECONDS:-400}

skip() {
  echo "SKIPPED: $*"
  exit 77
}

# Debian's kernel and its modules, unpacked and not installed; all of it or nothing is in the cache.
fetch_kernel() {
  [[ -e $cache/complete ]] && return 0
  local new=$cache.new.$$ package version start size
  rm -rf "$new"
  mkdir -p "$new/tree"
  package=$(apt-cache depends linux-image-amd64 2> /dev/null | awk '/Depends: linux-image-[0-9]/ { print $2; exit }')
  [[ -n $package ]] || { rm -rf "$new" && skip "apt knows no linux-image-amd64 to take a kernel from; run apt-get update"; }
  (cd "$new" && apt-get -qq download "$package") > "$new/log" 2>&1 ||
    { tail -n 1 "$new/log" && rm -rf "$new" && skip "apt-get could not download $package: is there a network?"; }
  dpkg --fsys-tarfile "$new"/linux-image-*.deb | tar x -C "$new/tree" --wildcards './boot/vmlinuz-*' \
    './lib/modules/*/modules.*' './lib/modules/*/kernel/'{drivers/{net/can,net/mii.ko,hid,usb,virtio,input},net/can,lib}'*'
  version=$(ls "$new/tree/lib/modules")
  depmod -b "$new/tree" "$version" 2> /dev/null

  # The emulator starts an unpacked kernel three seconds sooner than one that unpacks itself. Where it lies in the image:
  # the x86 boot protocol, fields setup_sects, payload_offset and payload_length.
  local image=("$new"/tree/boot/vmlinuz-*)
  start=$(((1 + $(od -An -tu1 -j $((0x1f1)) -N1 "${image[0]}")) * 512 + $(od -An -tu4 -j $((0x248)) -N4 "${image[0]}")))
  size=$(od -An -tu4 -j $((0x24c)) -N4 "${image[0]}")
  tail -c "+$((start + 1))" "${image[0]}" | head -c "$size" | xz -dc --single-stream > "$new/vmlinux" 2> /dev/null || true
  [[ $(head -c 4 "$new/vmlinux" | tail -c 3) == ELF ]] || { rm -rf "$new" && skip "$package is not compressed by xz"; }
  rm -rf "$new"/*.deb "$new/tree/boot" "$new/log"
  echo "$version" > "$new/version"
  touch "$new/complete"
  rm -rf "$cache"
  mv "$new" "$cache"
}

# put FILE: copies a file to the same place in the guest's root; put_program also what it is linked with.
put() {
  mkdir -p "$root$(dirname "$1")"
  [[ -e $root$1 ]] || cp -L "$1" "$root$1"
}
put_program() {
  local library
  put "$1"
  while read -r library; do put "$library"; done < <(ldd "$1" | awk '$2 == "=>" && $3 ~ /^\// { print $3 } $1 ~ /^\// { print $1 }')
}

# The guest's whole root: busybox, udevd (libusb sees arrivals through it), the modules in loading order, the programs.
make_root() {
  local module file program
  mkdir -p "$root"/{bin,dev,proc,sys,tmp,run,etc,modules}
  cp "$(command -v busybox)" "$root/bin/"
  put_program "$(command -v udevadm)"
  mkdir -p "$root/lib/systemd"
  ln -sf "$(command -v udevadm)" "$root/lib/systemd/systemd-udevd"
  for file in /lib/*-linux-gnu/libgcc_s.so.1; do put "$file"; done  # opened by pthread_cancel, not linked
  for module in $modules; do
    modprobe -d "$cache/tree" -S "$(cat "$cache/version")" --show-depends "$module" | awk '$1 == "insmod" { print $2 }'
  done | awk '!seen[$0]++' > "$work/modules"
  while read -r file; do
    cp "$file" "$root/modules/"
    basename "$file"
  done < "$work/modules" > "$root/modules/order"
  for program in "$@"; do put_program "$(realpath -s "$program")"; done
  {
    echo '#!/bin/busybox sh'
    echo '/bin/busybox --install -s /bin; export PATH=/bin HOME=/ GTEST_COLOR=no'
    echo 'mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev; mount -t tmpfs run /run'
    echo 'mkdir -p /dev/pts /dev/shm; mount -t devpts pts /dev/pts; mount -t tmpfs shm /dev/shm'
    echo 'exec < /dev/null > /dev/ttyS0 2>&1; stty -F /dev/ttyS0 raw -echo; stty -F /dev/ttyS2 raw -echo'
    echo 'ip link set lo up'
    echo 'while read m; do insmod /modules/$m || echo "the guest could not load $m"; done < /modules/order'
    echo '/lib/systemd/systemd-udevd --daemon'
    echo 'failed=0'
    for program in "$@"; do
      printf '%q; code=$?; [ $code = 0 ] || { failed=1; echo "%s ended with status $code"; }\n' \
        "$(realpath -s "$program")" "$(basename "$program")"
    done
    echo 'echo "$failed" > /dev/ttyS2; sync; poweroff -f'
  } > "$root/init"
  chmod +x "$root/init"
  (cd "$root" && find . | cpio -o -H newc --quiet) > "$work/initrd"
}

for tool in qemu-system-x86_64:qemu-system-x86 busybox:busybox-static cpio:cpio modprobe:kmod udevadm:udev xz:xz-utils apt-get:apt; do
  PATH=$PATH:/usr/sbin:/sbin command -v "${tool%%:*}" > /dev/null || skip "${tool%%:*} is missing (Debian: ${tool##*:})"
done
PATH=$PATH:/usr/sbin:/sbin
[[ $(uname -m) == x86_64 ]] || skip "the guest is an x86_64 machine, and this is none: its programs do not run there"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
fetch_kernel
make_root "$@"

# One processor and no acceleration: the same on every machine, and time in there goes by evenly. The first serial line is
# the programs' output, the second the kernel's, the third brings the result.
timeout -k 2 "$seconds" qemu-system-x86_64 -nodefaults -no-user-config -no-reboot -display none -M q35,accel=tcg -cpu max \
  -smp 1 -m "$memory_mb" -kernel "$cache/vmlinux" -initrd "$work/initrd" \
  -append "console=ttyS1 quiet loglevel=4 panic=-1 mitigations=off nokaslr tsc=reliable no_timer_check" \
  -object can-bus,id=bus -device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus \
  -serial stdio -serial "file:$work/kernel" -serial "file:$work/result" < /dev/null 2> "$work/emulator" | tr -d '\r' || true

case $(tr -d '\r\n' < "$work/result" 2> /dev/null) in
  0) exit 0 ;;
  1) exit 1 ;;
esac
echo "the guest ended without a result, or did not end within $seconds s; the end of its kernel's log:"
tail -n 20 "$work/kernel"
cat "$work/emulator"
exit 1
