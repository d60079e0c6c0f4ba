#!/usr/bin/python3
"""What the page costs, for the how-to "see what is felt"; asserts nothing. ASPERITY PROBE FIXED MODEL SECONDS.

Device ticks on the real clock without a page and with 0, 1 and 5 of them, in turn for so many seconds; then how long
MODEL takes to a headless Chromium, and how often that draws it."""
import http.client
import json
import os
import re
import statistics
import struct
import subprocess
import sys
import threading
import time
import urllib.request

EXE, PROBE, FIXED, MODEL, SECONDS = sys.argv[1:6]


def page(port, stop):
    """Asks as a page does that draws 60 times a second."""
    line, after = http.client.HTTPConnection("127.0.0.1", port, timeout=5), 0
    while not stop.is_set():
        try:
            line.request("GET", f"/frame?after={after}")
            after = int(struct.unpack_from("<d", line.getresponse().read(), 32)[0])
        except (OSError, http.client.HTTPException, struct.error):
            line.close()
        time.sleep(1 / 60)


def session(pages):
    """Tick times of a session of 4 s; None: without --view."""
    view = [] if pages is None else ["--view", "0"]
    process = subprocess.Popen([EXE, "run", "--probe", PROBE, "--fixed", FIXED, "--clock", "real", "--seconds", "4", "--json", *view],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    stop, found = threading.Event(), None
    while view and found is None:
        found = re.search(r"http://[0-9.]+:(\d+)", process.stderr.readline())
    clients = [threading.Thread(target=page, args=(int(found[1]), stop)) for _ in range(pages or 0)]
    for c in clients:
        c.start()
    out, _ = process.communicate(timeout=60)
    stop.set()
    for c in clients:
        c.join()
    return json.loads(out)["device_loop"]["tick_time"]


def ticks():
    found, until = {None: [], 0: [], 1: [], 5: []}, time.monotonic() + float(SECONDS)
    while time.monotonic() < until:
        for pages, times in found.items():
            times.append(session(pages))
    for pages, times in found.items():
        told = []
        for key in ("p50", "p99"):
            us = sorted(1e6 * t[key] for t in times)
            told.append(f"{key} {statistics.median(us):.0f} us ({us[0]:.0f} to {us[-1]:.0f})")
        print(f"{'no --view' if pages is None else f'{pages} pages'}: {', '.join(told)}, {len(times)} sessions")


def model():
    sys.argv[1:] = [EXE, PROBE, FIXED, "."]  # what page_test reads
    import browser
    import page_test
    program, missing = browser.find()
    if program is None:
        print(missing)
        return
    chromium, served = browser.Browser(program), page_test.Served("view", MODEL, "--port", "0")
    seconds, shown = [], []
    for _ in range(5):
        begin = time.monotonic()
        size = len(urllib.request.urlopen(served.url + "mesh/0").read())
        seconds.append(time.monotonic() - begin)
    for _ in range(3):
        chromium.open("about:blank")
        begin = time.monotonic()
        chromium.open(served.url)
        chromium.wait("asperity.page && asperity.page.ready && asperity.page.frames > 0", 120)
        shown.append(time.monotonic() - begin)
    body = json.loads(chromium.value("JSON.stringify(asperity.page.description.bodies[0])"))
    before = chromium.value("asperity.page.frames")
    time.sleep(8)
    frames = (chromium.value("asperity.page.frames") - before) / 8
    print(f"{body['facts']['full_triangles']} triangles baked, {body['triangles']} shown, {size} bytes over loopback in "
          f"{1e3 * statistics.median(seconds):.0f} ms, seen after {min(shown):.1f} to {max(shown):.1f} s, {frames:.1f} frames a second")
    chromium.open("about:blank")
    served.end()
    chromium.close()


ticks()
model()
print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
