#!/usr/bin/env python3
"""heap_room_test.py ASPERITY PROBE.glb FIXED.glb: the command asks the kernel for few pages when it loads models, and
answers the same where it may not."""
import os
import resource
import subprocess
import sys

SKIPPED = 77
HUGE = "/sys/kernel/mm/transparent_hugepage/enabled"


def asked(command, limited):
    """What `query` prints, and how often it had to wait for a page."""

    def limit():
        # Far more than it needs; that there is a limit is enough for it to leave the heap as it is.
        if limited:
            resource.setrlimit(resource.RLIMIT_DATA, (1 << 40, 1 << 40))

    process = subprocess.Popen(command, stdout=subprocess.PIPE, preexec_fn=limit)
    printed = process.stdout.read()
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)} ended with {status}")
    return printed, used.ru_minflt


def main():
    asperity, probe, fixed = sys.argv[1:]
    command = [asperity, "query", "--probe", probe, "--fixed", fixed, "--probe-pose", "0 0 0.02 0 0 0 1", "--json"]
    with_room, few = asked(command, limited=False)
    without, many = asked(command, limited=True)
    print(f"page faults: {few} with a prepared heap, {many} without")
    if with_room != without:
        sys.exit("the answers differ")
    if not os.path.exists(HUGE) or "[never]" in open(HUGE, encoding="ascii").read():
        print("SKIPPED: this kernel has no large pages")
        sys.exit(SKIPPED)
    if few * 5 > many:
        sys.exit("a prepared heap saves fewer than four of five page faults")


main()
