#!/usr/bin/python3
"""The live page, the replay and the exported page in a headless Chromium. ASPERITY PROBE FIXED FOLDER."""
import array
import csv
import json
import math
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import time
import unittest

import browser

EXE, PROBE, FIXED, FOLDER = sys.argv[1:5]
PICTURES = pathlib.Path(FOLDER)
SEED = int.from_bytes(os.urandom(4), "little") if "ASPERITY_SEED" not in os.environ else int(os.environ["ASPERITY_SEED"])

TEXTS = "h1, p, button, label, summary, figcaption, b, li, th, td, output, #scale-text"


class Served:
    """A command that serves a page."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([EXE, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url, said = None, []
        while self.url is None:
            line = self.process.stderr.readline()
            assert line != "", said
            said.append(line)
            found = re.search(r"http://\S+/", line)
            self.url = found[0] if found else None

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=30)


def moved_ply(ply, by):
    """A binary PLY whose vertices are x, y and z as floats, moved up."""
    head = ply.index(b"end_header\n") + 11
    count = int(re.search(rb"element vertex (\d+)", ply)[1])
    end = head + 12 * count
    numbers = array.array("f", ply[head:end])
    for i in range(2, len(numbers), 3):
        numbers[i] += by
    return ply[:head] + numbers.tobytes() + ply[end:]


def is_session(cmdline):
    """Whether a process is a session of this test's models that a hand leads."""
    try:
        line = cmdline.read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return False
    return line[0] == "asperity" and "mouse" in line and str(pathlib.Path(FIXED).resolve().parent) in " ".join(line)


def models(*more):
    return ["--probe", PROBE, "--fixed", FIXED, *more]


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = browser.Browser(browser.find()[0])

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        self.browser.complaints.clear()
        self.browser.requests = []
        self.browser.size(1280, 720)
        self.browser.dark(False)

    def tearDown(self):
        self.assertEqual(self.browser.complaints, [])

    def test_live(self):
        b = self.browser
        served = Served("run", *models("--view", "0", "--seconds", "600"))
        try:
            b.open(served.url)
            b.wait("asperity.page.ready && asperity.page.history.size > 500 && asperity.page.scene.drawn.contacts > 0 && asperity.page.contactMap", 90)
            b.value("document.getElementById('pause').click()")
            b.wait("asperity.page.paused && document.getElementById('state').textContent === 'paused'")
            time.sleep(0.5)
            # What was drawn against what the server tells of the same row: length, and where the arrow points.
            found = json.loads(b.value("""(() => {
              const p = asperity.page, a = p.scene.drawn.arrows.hand_force, row = p.state.row, h = p.history;
              return JSON.stringify({tip: a.tip, from: a.from, scale: a.scale, felt: Array.from(h.some(row, 'hand_fx', 3))});
            })()"""))
            drawn = [(t - f) / found["scale"] for t, f in zip(found["tip"], found["from"])]
            self.assertGreater(math.hypot(*found["felt"]), 0.1)
            for one, other in zip(drawn, found["felt"]):
                self.assertAlmostEqual(one, other, delta=0.01 * math.hypot(*found["felt"]))
            for _ in range(100):
                if not b.value("document.getElementById('contact').hidden"):
                    break
                b.value("asperity.tell('step=10')")
                time.sleep(0.3)
            # The map at the deepest contact: the surface goes through the contact, within the points' distance; it does
            # not depend on where the world is; and the probe that is drawn off it leaves that much of a gap.
            away = random.Random(SEED).uniform(2e-4, 6e-4)
            found = json.loads(b.value("""(() => {
              const p = asperity.page, m = p.contactMap, s = p.scene, { add, turn, times } = asperity.vectors;
              const body = s.bodies.find((x) => x.name === m.body), q = [0.5, -0.5, 0.5, 0.5], product = (a, b) => [
                a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
                a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
              const moved = (pose) => [...add(turn(q, pose.slice(0, 3)), [0.1, -0.2, 0.3]), ...product(q, pose.slice(3))];
              const lifted = (pose, way = 1) => [...add(pose.slice(0, 3), times(-way * AWAY, m.deepest.n)), ...pose.slice(3)];
              const turned = { ...m.deepest, p: moved([...m.deepest.p, 0, 0, 0, 1]).slice(0, 3), n: turn(q, m.deepest.n) };
              const fixed = (pose) => ({ mesh: body.drawing.mesh, pose }), probe = (pose) => ({ mesh: s.bodies[0].drawing.mesh, pose });
              const plain = asperity.contactMap(fixed(body.pose), probe(p.contactProbe), m.deepest, m.frame.u, m.radius);
              const whole = asperity.contactMap(fixed(moved(body.pose)), probe(moved(p.contactProbe)), turned, turn(q, m.frame.u), m.radius);
              const off = asperity.contactMap(fixed(body.pose), probe(lifted(p.contactProbe)), m.deepest, m.frame.u, m.radius);
              const sunk = asperity.contactMap(fixed(lifted(body.pose, -1)), probe(p.contactProbe), m.deepest, m.frame.u, m.radius);
              const both = (one, other) => Array.from(one).map((x, i) => [x, other[i]]).filter((x) => x.every((y) => !Number.isNaN(y)));
              const apart = (one, other, by) => { const d = both(one, other).map(([x, y]) => Math.abs(y - x - by)).sort((x, y) => x - y); return d[Math.floor(0.9 * d.length)]; };
              const at = m.cells * (m.cells >> 1) + (m.cells >> 1);
              return JSON.stringify({ centre: plain.surface[at], gap: plain.clearance[at], step: body.step_m + s.bodies[0].step_m, depth: m.deepest.depth,
                radius: m.radius, cells: both(plain.clearance, plain.clearance).length, world: apart(plain.surface, whole.surface, 0) + apart(plain.clearance, whole.clearance, 0),
                lifted: apart(plain.clearance, off.clearance, AWAY) + apart(plain.clearance, sunk.clearance, AWAY), hidden: document.getElementById('contact').hidden });
            })()""".replace("AWAY", str(away))))
            self.assertFalse(found["hidden"])
            self.assertGreater(found["cells"], 20)
            self.assertLess(found["world"], 1e-6)
            self.assertLess(found["lifted"], 2e-5)
            self.assertLess(abs(found["centre"]), 0.3 * found["radius"], found)
            b.value("document.querySelector('[data-part=map]').click()")
            b.value("asperity.page.changed = asperity.page.dirty = true")
            b.wait("document.getElementById('contact').hidden")
            b.value("document.querySelector('[data-part=map]').click()")
            b.value("asperity.page.changed = asperity.page.dirty = true")
            b.wait("!document.getElementById('contact').hidden")
            for dark in (False, True):
                b.dark(dark)
                b.value(f"document.documentElement.dataset.theme === '{'dark' if dark else 'light'}' || document.getElementById('theme').click()")
                for width, height in ((1280, 720), (390, 844)):
                    b.size(width, height)
                    time.sleep(0.6)
                    b.picture(PICTURES / f"live-{width}-{'dark' if dark else 'light'}.png")
                    self.assertLessEqual(b.value("document.documentElement.scrollWidth"), width, "nothing is cut off")
                self.assertEqual(b.too_little_contrast(TEXTS), [])
            self.assertGreater(b.value("asperity.csvOf({from: 0, to: 1e9}).split('\\n').length"), 400)
            with_keys = set()
            b.size(1280, 720)
            for _ in range(60):
                b.key("Tab")
                with_keys.add(b.value("document.activeElement.id || document.activeElement.dataset.from || document.activeElement.tagName"))
            for wanted in ("scene", "theme", "hold", "time", "span", "table", "pause", "step", "speed", "colours", "picture", "turn", "front", "touch"):
                self.assertIn(wanted, with_keys)
            before = b.value("asperity.page.scene.camera.yaw")
            b.value("document.getElementById('scene').focus()")
            b.key("ArrowRight")
            self.assertNotEqual(b.value("asperity.page.scene.camera.yaw"), before)
        finally:
            b.open("about:blank")  # so that it does not complain about the server's end
            served.end()

    def test_a_mouse_leads_the_hand(self):
        b = self.browser
        served = Served("run", *models("--view", "0", "--motion", "mouse", "--seconds", "600"))
        try:
            b.open(served.url)
            b.wait("asperity.page.ready && asperity.page.state && asperity.page.history.size > 100", 90)
            self.assertFalse(b.value("document.getElementById('hint').hidden"))
            b.value("document.querySelector('[data-from=front]').click()")
            b.wait("!asperity.page.changed")

            def probe():
                """Where the probe is on the page, metres for a pixel there, and the numbers of the newest row."""
                return json.loads(b.value("""(() => {
                  const p = asperity.page, at = p.scene.onCanvas(p.state.probe.centre), r = p.scene.canvas.getBoundingClientRect();
                  return JSON.stringify({x: r.x + at.x, y: r.y + at.y, pixel: at.pixel, p: p.state.target.p, q: p.state.target.q,
                                         hand: p.state.hand.force, contacts: p.history.value(p.state.row, p.history.column.contacts)});
                })()"""))

            def drag(from_, x, y, **more):
                b.mouse("mousePressed", from_["x"], from_["y"], button="left", buttons=1, clickCount=1, **more)
                for i in range(1, 11):
                    b.mouse("mouseMoved", from_["x"] + x * i / 10, from_["y"] + y * i / 10, button="left", buttons=1, **more)
                b.mouse("mouseReleased", from_["x"] + x, from_["y"] + y, button="left", **more)

            begin, yaw = probe(), b.value("asperity.page.scene.camera.yaw")
            self.assertEqual(begin["contacts"], 0)
            drag(begin, 40, -30)
            wanted = [begin["p"][0] + 40 * begin["pixel"], begin["p"][1], begin["p"][2] + 30 * begin["pixel"]]
            at = f"asperity.page.state.target.p.every((x, i) => Math.abs(x - {wanted}[i]) < 4e-4)"
            b.wait(at)
            self.assertEqual(b.value("asperity.page.scene.camera.yaw"), yaw)
            # Away from the probe the mouse turns the view, and the hand stays.
            drag({"x": begin["x"] + 40, "y": begin["y"] + 200}, 30, 0)
            self.assertNotEqual(b.value("asperity.page.scene.camera.yaw"), yaw)
            self.assertTrue(b.value(at))
            b.value("document.querySelector('[data-from=front]').click()")
            # Pressed against the body it is held up, and less than a hand's spring away from where it is wanted.
            now = probe()
            drag(now, 0, 0.03 / now["pixel"])
            b.wait("asperity.page.history.value(asperity.page.state.row, asperity.page.history.column.contacts) > 0")
            b.wait("asperity.page.state.hand.force[2] > 0.3")
            # Keys lead it back; with Alt the mouse turns it.
            b.value("document.getElementById('scene').focus()")
            for _ in range(60):
                b.key("w")
            b.wait("asperity.page.history.value(asperity.page.state.row, asperity.page.history.column.contacts) === 0")
            b.wait("Math.hypot(...asperity.page.state.hand.force) < 0.05")
            before = probe()
            drag(before, 50, 0, modifiers=1)
            b.wait("Math.abs(2 * Math.acos(Math.min(1, Math.abs(asperity.page.state.target.q.reduce((s, x, i) => s + x * "
                   f"{before['q']}[i], 0)))) - 0.4) < 0.03")
            b.picture(PICTURES / "mouse.png")
        finally:
            b.open("about:blank")
            served.end()

    def test_replay_shows_the_row_of_its_time(self):
        b = self.browser
        recording = PICTURES / "recording.csv"
        subprocess.run([EXE, "run", *models("--seconds", "2", "--quiet", "--record", str(recording))], check=True)
        with recording.open() as table:
            rows = list(csv.DictReader(table))
        served = Served("view", str(recording), *models("--port", "0"))
        try:
            b.open(served.url)
            b.wait("asperity.page.state", 90)
            for share in (0.25, 0.5, 0.9):
                b.value(f"""(() => {{ const s = document.getElementById('time'); s.value = {round(1000 * share)};
                        s.dispatchEvent(new Event('input')); }})()""")
                b.wait(f"Math.abs(asperity.page.at - {share} * {float(rows[-1]['time_s'])}) < 1e-9 && !asperity.page.changed")
                time.sleep(0.2)
                row = rows[int(share * float(rows[-1]["time_s"]) / 1e-3 + 1e-6)]
                shown = b.value("[...asperity.page.scene.bodies[0].pose.slice(0, 3), ...asperity.page.state.hand.force]")
                wanted = [float(row[k]) for k in ("probe_x_m", "probe_y_m", "probe_z_m", "hand_fx_n", "hand_fy_n", "hand_fz_n")]
                for one, other in zip(shown, wanted):
                    self.assertAlmostEqual(one, other, delta=1e-6 + 1e-5 * abs(other))
            b.picture(PICTURES / "replay.png")
        finally:
            b.open("about:blank")  # so that it does not complain about the server's end
            served.end()

    def test_two_recordings_beside_each_other(self):
        b = self.browser
        draw = random.Random(SEED)
        files, tables = [PICTURES / "a.csv", PICTURES / "b.csv"], []
        ways = (("--seconds", "1.2"), ("--seconds", "0.7", "--device-rate", "500", "--press", "0.004", "--seed", str(draw.randrange(1, 99))))
        for file, how in zip(files, ways):
            subprocess.run([EXE, "run", *models(*how, "--quiet", "--record", str(file))], check=True)
            with file.open() as table:
                tables.append(list(csv.DictReader(table)))
        page = PICTURES / "two.html"
        subprocess.run([EXE, "view", *map(str, files), *models("--export", str(page), "--quiet")], check=True)
        served = Served("view", *map(str, files), *models("--port", "0"))

        def look_at(time_s):
            b.value(f"""(() => {{ const s = document.getElementById('time'); s.value = 1000 * {time_s} / asperity.page.histories[0].time(asperity.page.histories[0].end - 1);
                    s.dispatchEvent(new Event('input')); }})()""")
            b.wait(f"Math.abs(asperity.page.at - {time_s}) < 2e-3 && !asperity.page.changed")
            b.value("asperity.page.changed = asperity.page.dirty = true")
            b.wait("!asperity.page.changed")
            return b.value("asperity.page.at")

        try:
            b.open(served.url)
            b.wait("asperity.page.state && asperity.page.compared", 90)
            told = b.value("document.getElementById('differs').textContent")
            self.assertIn("A a", told)
            self.assertIn("lengths differ: A 1.2 s, B 0.7 s", told)
            self.assertIn("rates differ: A 1000 Hz, B 500 Hz", told)
            for wanted in (draw.uniform(0.1, 0.65) for _ in range(3)):
                at = look_at(wanted)
                for i, rows in enumerate(tables):
                    row = [r for r in rows if float(r["time_s"]) <= at + 1e-9][-1]
                    hand = f"asperity.page.state.hands[{i}]"
                    shown = b.value(f"[...asperity.page.scene.bodies[{i}].pose.slice(0, 3), ...{hand}.hand.force]")
                    for one, name in zip(shown, ("probe_x_m", "probe_y_m", "probe_z_m", "hand_fx_n", "hand_fy_n", "hand_fz_n")):
                        self.assertAlmostEqual(one, float(row[name]), delta=1e-6 + 1e-5 * abs(one))
                    # Each hand has an arrow of its own.
                    arrow = json.loads(b.value(f"JSON.stringify(asperity.page.scene.drawn.arrows.hand_force_{'ab'[i]})"))
                    if arrow["length"] > 0:
                        for t, f, n in zip(arrow["tip"], arrow["from"], ("hand_fx_n", "hand_fy_n", "hand_fz_n")):
                            self.assertAlmostEqual((t - f) / arrow["scale"], float(row[n]), delta=0.02)
            # Both curves are there, each in the colour of its legend, and that of B ends where B does.
            colours = json.loads(b.value("JSON.stringify([...document.querySelectorAll('#force-legend b')].map((e) => getComputedStyle(e).color))"))
            self.assertEqual(len(set(colours)), 2)
            b.value("document.getElementById('span').value = '0'; document.getElementById('span').dispatchEvent(new Event('change'))")
            look_at(0.1)
            ends = [self.last_column("force", c) for c in colours]
            self.assertGreater(ends[0], 0.97)
            self.assertAlmostEqual(ends[1], 0.7 / 1.2, delta=0.03)
            b.picture(PICTURES / "two-1280-light.png")
            look_at(1.0)
            self.assertIn("B does not run", b.value("document.getElementById('readout').textContent"))
            lines = b.value("asperity.csvOf({from: 0, to: 1e9})").strip().split("\n")
            self.assertEqual([sum(line.startswith(f"{x},") for line in lines) for x in "AB"], [len(t) for t in tables])
            look_at(0.5)
            b.dark(True)
            b.value("document.documentElement.dataset.theme === 'dark' || document.getElementById('theme').click()")
            for width, height in ((1280, 720), (390, 844)):
                b.size(width, height)
                time.sleep(0.6)
                b.picture(PICTURES / f"two-{width}-dark.png")
                self.assertLessEqual(b.value("document.documentElement.scrollWidth"), width, "nothing is cut off")
                self.assertEqual(b.too_little_contrast(TEXTS), [])
            b.value("document.getElementById('theme').click()")
            self.assertEqual(b.too_little_contrast(TEXTS), [])
            b.size(1280, 720)
            b.requests = []
            b.open(page.as_uri())
            b.wait("asperity.page.ready && asperity.page.compared && asperity.page.histories[1].size > 300", 90)
            self.assertEqual([u for u in b.requests if not u.startswith(("file:", "data:"))], [])
        finally:
            b.open("about:blank")
            served.end()

    def last_column(self, canvas, colour):
        """How far to the right a canvas has a colour, as a share of its curves' width."""
        return self.browser.value(f"""(() => {{
          const c = document.getElementById('{canvas}'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
          const [r, g, b] = '{colour}'.match(/\\d+/g).map(Number);
          let last = 0;
          for (let y = 0; y < c.height; ++y) for (let x = 0; x < c.width; ++x) {{
            const i = 4 * (y * c.width + x);
            if (d[i + 3] > 150 && Math.abs(d[i] - r) + Math.abs(d[i + 1] - g) + Math.abs(d[i + 2] - b) < 40) last = Math.max(last, x);
          }}
          return (last - 62) / (c.width - 64);
        }})()""")

    def test_a_bake_beside_its_full_mesh(self):
        b = self.browser
        # The full mesh, moved: how far the textured surface is from it is known, but at the edges.
        by = 1e-3 * random.Random(SEED).uniform(0.6, 1.4)
        moved = PICTURES / "moved.ply"
        moved.write_bytes(moved_ply(pathlib.Path(FIXED).with_suffix(".ply").read_bytes(), by))
        page = PICTURES / "bake.html"
        subprocess.run([EXE, "view", FIXED, "--original", str(moved), "--export", str(page), "--quiet"], check=True)
        b.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
        b.open(page.as_uri())
        b.wait("asperity.page.ready && asperity.page.frames > 1", 90)
        self.assertFalse(b.value("asperity.page.turning"), "motion is reduced")
        b.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "no-preference"}])
        found = json.loads(b.value("""(async () => {
          const mesh = await asperity.loadMesh(0), high = asperity.page.description.bodies[0].error_m.high, top = [], side = [], up = [];
          for (let i = 0; i < mesh.points; ++i) {
            const share = [0, 1, 2].map((k) => mesh.places[4 * i + k] / 65535), d = mesh.errors[i] / 65535 * high;
            if ([0, 1].every((k) => share[k] > 0.1 && share[k] < 0.9) && Math.abs(mesh.normals[4 * i + 2]) > 120) top.push(d);
            if ([0, 1].every((k) => Math.abs(share[k] - 0.5) < 0.15) && mesh.normals[4 * i + 2] > 40) up.push(d);
            if (share[2] > 0.2 && share[2] < 0.8 && Math.abs(mesh.normals[4 * i + 2]) < 5) side.push(d);
          }
          const middle = (list) => list.sort((x, y) => x - y)[list.length >> 1];
          return JSON.stringify({ top: middle(top), up: middle(up), side: middle(side), tops: top.length, sides: side.length });
        })()"""))
        self.assertGreater(min(found["tops"], found["sides"]), 100)
        self.assertAlmostEqual(found["top"], by, delta=0.1 * by)
        self.assertLess(found["side"], 0.2 * by)
        # What is drawn: a top that is coloured as its distance is, and every kind of surface differs from the others.
        self.assertIsNone(b.value("document.querySelector('#colours [value=error]').disabled || null"))
        pictures = {}
        for colours, surface in (("clay", "textured"), ("error", "textured"), ("pieces", "textured"), ("relief", "textured"),
                                 ("pieces", "coarse"), ("clay", "both")):
            for name, value in (("colours", colours), ("surface", surface)):
                b.value(f"(() => {{ const s = document.getElementById('{name}'); s.value = '{value}'; s.dispatchEvent(new Event('change')); }})()")
            self.assertEqual(b.value("document.getElementById('values').hidden"), colours not in ("error", "relief"))
            pictures[colours, surface] = json.loads(b.value("""(() => {
              const s = asperity.page.scene, gl = s.gl;
              s.lookFrom('top');
              s.draw(null);
              const [w, h] = [s.canvas.width, s.canvas.height], out = new Uint8Array(4 * w * h);
              gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, out);
              const kinds = new Set();
              for (let i = 0; i < out.length; i += 4) kinds.add((out[i] >> 5) << 6 | (out[i + 1] >> 5) << 3 | out[i + 2] >> 5);
              const about = [[], [], []];
              for (let y = -50; y <= 50; ++y) for (let x = -50; x <= 50; ++x) about.forEach((c, k) => c.push(out[4 * (w * ((h >> 1) + y) + (w >> 1) + x) + k]));
              return JSON.stringify({ middle: about.map((c) => c.sort((p, q) => p - q)[c.length >> 1]), kinds: [...kinds] });
            })()"""))
            b.value("asperity.page.scene.lookFrom('corner')")
            time.sleep(0.4)
            b.picture(PICTURES / f"bake-{colours}-{surface}.png")
        of_heat = b.value(f"(() => {{ const x = Math.min(0.9999, {found['up']} / asperity.page.description.bodies[0].error_m.high) * 6, k = Math.floor(x);"
                          " return asperity.heat[k].map((c, i) => c + (asperity.heat[k + 1][i] - c) * (x - k)); })()")
        middle = pictures["error", "textured"]["middle"]
        # The light takes up to 14 % of a colour away.
        self.assertLess(max(abs(m - h) for m, h in zip(middle, of_heat)), 60, (middle, of_heat))
        self.assertGreaterEqual(len(pictures["pieces", "textured"]["kinds"]), 4)
        self.assertEqual(len({json.dumps(p) for p in pictures.values()}), len(pictures))
        b.value("asperity.page.scene.paint = 'error', asperity.showValues(asperity.page)")
        told = re.search(r"([\d.]+) (\w?)m", b.value("document.getElementById('values-high').textContent"))
        high = b.value("asperity.page.description.bodies[0].error_m.high")
        self.assertAlmostEqual(float(told[1]) * {"m": 1e-3, "\u00b5": 1e-6}[told[2]], high, delta=0.06 * high)
        for width, height in ((1280, 720), (390, 844)):
            b.size(width, height)
            for _ in range(2):
                b.value("document.getElementById('theme').click()")
                time.sleep(0.4)
                self.assertEqual(b.too_little_contrast(TEXTS), [])
            self.assertLessEqual(b.value("document.documentElement.scrollWidth"), width, "nothing is cut off")
            b.picture(PICTURES / f"bake-{width}.png")
        b.value("document.getElementById('turn').click()")
        self.assertTrue(b.value("asperity.page.turning"))
        # Without the full mesh the choice says what it needs.
        subprocess.run([EXE, "view", FIXED, "--export", str(page), "--quiet"], check=True)
        b.open(page.as_uri())
        b.wait("asperity.page.ready && asperity.page.frames > 1", 90)
        self.assertTrue(b.value("document.querySelector('#colours [value=error]').disabled"))
        self.assertIn("--original", b.value("document.querySelector('#colours [value=error]').textContent"))
        self.assertTrue(b.value("asperity.page.turning"))
        b.value("document.getElementById('turn').click()")
        self.assertFalse(b.value("asperity.page.turning"))

    def test_a_gallery_starts_sessions(self):
        b = self.browser
        served = Served("view", str(pathlib.Path(FIXED).parent), "--port", "0")
        names = sorted(p.stem for p in pathlib.Path(FIXED).parent.glob("*.glb"))

        def children():
            """What runs as a session now; one that has ended and was not yet waited for does not."""
            found = []
            for task in pathlib.Path(f"/proc/{served.process.pid}/task").iterdir():
                for pid in (task / "children").read_text().split():
                    line = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().decode().split("\0")
                    if len(line) > 1:
                        found.append(line[1:])
            return found

        def ask(what):
            return b.value(f"fetch('do?{what}', {{method: 'POST', headers: {{'X-Asperity': '1'}}}}).then((r) => r.status)")

        try:
            b.open(served.url)
            b.wait("document.querySelectorAll('#probes input').length > 0", 60)
            self.assertEqual(b.value("[...document.querySelectorAll('#bodies label')].map((e) => e.textContent)"), names)
            self.assertEqual(children(), [])
            for width, height in ((390, 844), (1280, 720)):
                b.size(width, height)
                for _ in range(2):
                    b.value("document.getElementById('theme').click()")
                    self.assertEqual(b.too_little_contrast(TEXTS), [])
                time.sleep(0.2)
                b.picture(PICTURES / f"gallery-{width}.png")
                self.assertLessEqual(b.value("document.documentElement.scrollWidth"), width, "nothing is cut off")
            # Nothing but numbers of the list is taken.
            for wrong in ("touch=0,99", "touch=-1,0", "touch=0", "touch=0,1,2", f"touch={names[0]},{names[1]}", "touch=/etc/passwd,0", "pause", "hand=0,0,0,0,0,0,1"):
                self.assertEqual(ask(wrong), 400, wrong)
            self.assertEqual(children(), [])
            b.complaints.clear()  # the refusals
            # With keys alone: the gear on the block, as it is listed.
            probe, fixed = names.index("gear"), names.index("block")
            b.value(f"document.querySelector('#probes input[value=\"{probe}\"]').click(), document.querySelector('#bodies input[value=\"{fixed}\"]').click()")
            b.value("document.getElementById('touch').focus()")
            b.key("Enter", text="\r")
            gallery = b.value("location.href")
            b.wait(f"location.href !== '{gallery}' && asperity.page.ready && asperity.page.history.size > 50", 90)
            self.assertTrue(b.value("asperity.page.description.leads"))
            self.assertEqual(b.value("asperity.page.description.title"), "gear on block")
            session, = children()
            self.assertEqual(session[:2] + session[6:7], ["run", "--probe", "mouse"])
            b.wait("asperity.page.state !== undefined")
            # Back ends it. The page that is asked is gone at once, so the answer comes first.
            b.value("void setTimeout(() => history.back(), 0)")
            b.wait("document.querySelectorAll('#probes input').length > 0 && !document.getElementById('touch').disabled", 60)
            until = time.monotonic() + 20
            while children() and time.monotonic() < until:
                time.sleep(0.1)
            self.assertEqual(children(), [])
            # A second wish ends the first session, and the gallery's end the last one.
            for first in (0, 1):
                self.assertEqual(ask(f"touch={first},{1 - first}"), 204)
                until = time.monotonic() + 60
                while b.value("asperity.loadSession().then((s) => s.phase)") != "running" and time.monotonic() < until:
                    time.sleep(0.1)
                self.assertEqual(len(children()), 1)
        finally:
            b.complaints[:] = [c for c in b.complaints if "ERR_CONNECTION" not in c]  # of the session that was left
            b.open("about:blank")
            served.end()
        self.assertFalse([p for p in pathlib.Path("/proc").glob("[0-9]*/cmdline") if is_session(p)])

    def test_what_cannot_be_shown_is_said(self):
        recording = PICTURES / "short.csv"
        subprocess.run([EXE, "run", *models("--seconds", "0.1", "--quiet", "--record", str(recording))], check=True)
        for files, said in ((3 * [str(recording)], "two recordings"), ([str(recording), FIXED], "a recording and a model"), ([FIXED, PROBE], "one model"),
                            ([str(recording), "--original", FIXED], "--original is of a model")):
            answer = subprocess.run([EXE, "view", *files, *models("--port", "0")], capture_output=True, text=True, check=False)
            self.assertNotEqual(answer.returncode, 0)
            self.assertIn(said, answer.stderr)

    def test_exported_pages_open_alone(self):
        b = self.browser
        recording = PICTURES / "recording.csv"
        subprocess.run([EXE, "run", *models("--seconds", "1", "--quiet", "--record", str(recording))], check=True)
        for name, arguments in (("replay", [str(recording), *models()]), ("model", [FIXED])):
            page = PICTURES / f"exported-{name}.html"
            subprocess.run([EXE, "view", *arguments, "--export", str(page), "--quiet"], check=True)
            b.requests = []
            b.open(page.as_uri())
            b.wait("asperity.page.ready && asperity.page.frames > 1", 90)
            time.sleep(1)
            b.picture(PICTURES / f"exported-{name}.png")
            self.assertTrue(b.value("asperity.isExported()"))
            self.assertEqual([u for u in b.requests if not u.startswith(("file:", "data:"))], [])
            self.assertTrue(b.value("document.getElementById('trouble').hidden"))


if __name__ == "__main__":
    missing = browser.find()[1]
    if missing is not None:
        print(f"skipped: {missing}")
        sys.exit(77)
    PICTURES.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1] + sys.argv[5:])
