#!/usr/bin/python3
"""The moving picture at the top of README.md: a session's page in a headless Chromium. ASPERITY PROBE FIXED GIF."""
import base64
import io
import json
import pathlib
import re
import signal
import subprocess
import sys
import time

from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/system/view"))
import browser  # noqa: E402

MOST_BYTES = 3_000_000
SIZE, FACTOR = (1200, 660), 0.75  # of the page, and of the picture beside it
FRAMES, FRAME_MS, TICKS_BETWEEN = 24, 150, 60
COLOURS = 96


def frame_of(page):
    shot = base64.b64decode(page.call("Page.captureScreenshot", format="png")["data"])
    picture = Image.open(io.BytesIO(shot)).convert("RGB")
    return picture.resize([round(FACTOR * x) for x in SIZE], Image.LANCZOS)


def film(page):
    """A session of the virtual clock, step by step: as smooth on a slow machine as on a fast one."""
    page.wait("asperity.page.ready && asperity.page.history.size > 600 && asperity.page.scene.drawn.contacts > 0", 120)
    page.value("document.getElementById('pause').click()")
    page.wait("asperity.page.paused")
    page.value("document.querySelector('[data-from=touch]').click()")
    page.value("asperity.page.scene.zoom(1.25); asperity.page.scene.rotate(-0.35, 0.22)")
    frames = []
    for _ in range(FRAMES):
        before = page.value("asperity.page.history.end")
        page.value(f"fetch('/do?step={TICKS_BETWEEN}', {{method: 'POST', headers: {{'X-Asperity': '1'}}}})"
                   ".then((answer) => answer.status)")
        page.wait(f"asperity.page.history.end >= {before + TICKS_BETWEEN}")
        page.value(f"asperity.page.scene.rotate({0.5 / FRAMES}, 0)")
        page.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
        time.sleep(0.12)  # curves are drawn less often than the scene
        frames.append(frame_of(page))
    return frames


def write(frames, file):
    # One palette for all, so that what stands still is the same in every frame and costs nothing.
    some = Image.new("RGB", (frames[0].width, 4 * frames[0].height))
    for i in range(4):
        some.paste(frames[i * (len(frames) - 1) // 3], (0, i * frames[0].height))
    palette = some.quantize(COLOURS, method=Image.MEDIANCUT)
    reduced = [f.quantize(palette=palette, dither=Image.NONE) for f in frames]
    reduced[0].save(file, save_all=True, append_images=reduced[1:], duration=FRAME_MS, loop=0, optimize=False)
    return pathlib.Path(file).stat().st_size


def main():
    exe, probe, fixed, file = sys.argv[1:5]
    program, missing = browser.find()
    if missing:
        sys.exit(missing)
    session = subprocess.Popen([exe, "run", "--probe", probe, "--fixed", fixed, "--view", "0", "--seconds", "600"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    page = browser.Browser(program, *SIZE)
    try:
        url = None
        while url is None:
            line = session.stderr.readline()
            if line == "":
                sys.exit("the session ended before its page was there")
            found = re.search(r"http://\S+/", line)
            url = found[0] if found else None
        page.open(url)
        frames = film(page)
        if page.complaints:
            sys.exit(f"the page complains: {json.dumps(page.complaints)}")
    finally:
        page.close()
        session.send_signal(signal.SIGINT)
        session.wait(30)
    size = write(frames, file)
    print(f"{file}: {len(frames)} frames of {frames[0].width} x {frames[0].height}, {size} bytes")
    if size > MOST_BYTES:
        sys.exit(f"the picture is larger than {MOST_BYTES} bytes: fewer frames, or fewer colours")


if __name__ == "__main__":
    main()
