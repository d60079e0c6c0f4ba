#!/usr/bin/python3
"""The device panel: its page in a headless Chromium, and clients that do not behave. ASPERITY FOLDER."""
import http.client
import json
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

EXE, FOLDER = sys.argv[1:3]
PICTURES = pathlib.Path(FOLDER)
SEED = int.from_bytes(os.urandom(4), "little") if "ASPERITY_SEED" not in os.environ else int(os.environ["ASPERITY_SEED"])

class Panel:
    """A command that shows a device."""

    def __init__(self, *more):
        self.process = subprocess.Popen([EXE, "devices", "--view", "0", "--json", *more], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        said = self.process.stderr.readline()
        found = re.search(r"http://([0-9.]+):([0-9]+)/#token=([0-9a-f]+)", said)
        assert found, said
        self.url, self.host, self.port, self.token = found[0], found[1], int(found[2]), found[3]

    def end(self, how=signal.SIGINT):
        self.process.send_signal(how)
        out, _ = self.process.communicate(timeout=30)
        return json.loads(out)["panel"]

    def ask(self, path, method="POST", **other):
        headers = {"X-Asperity-Token": self.token, "X-Asperity": "1", **other.get("headers", {})}
        to = http.client.HTTPConnection(self.host, self.port, timeout=10)
        try:
            to.request(method, path, headers={k: v for k, v in headers.items() if v is not None})
            answer = to.getresponse()
            return answer.status, answer.read().decode()
        finally:
            to.close()

    def state(self):
        return json.loads(self.ask(f"/panel-state?after={10**18}", "GET")[1])

    def press(self, what="x,0.5"):
        status, body = self.ask(f"/do?press={what}")
        assert status == 200, body
        return json.loads(body)["press"]

    def hold(self, name, seconds, first=1):
        """Beats, and answers the largest force meanwhile and the number of the next beat."""
        until, most = time.monotonic() + seconds, 0.0
        while time.monotonic() < until:
            if self.ask(f"/do?beat={name},{first}")[0] != 204:
                break
            first += 1
            most = max(most, abs(self.state()["force"][0]))
            time.sleep(0.02)
        return most, first


def rests(panel, seconds=2.0):
    """Whether nothing is put out any more."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if panel.state()["force"] == [0, 0, 0]:
            return True
        time.sleep(0.01)
    return False


class Hostile(unittest.TestCase):
    def setUp(self):
        self.panel = Panel()

    def tearDown(self):
        if self.panel.process.poll() is None:
            self.panel.end()

    def test_what_is_refused(self):
        draws = random.Random(SEED)
        p = self.panel
        wanted = ["x,nan", "x,-nan", "x,inf", "x,-inf", "x,1e999", "x,1.0001", "x,-2", "x,0", "x,", "x", "", "w,0.1", "nan,0.1", "x,0.1,0.1",
                  "x,0x1", "x, 0.1", "xy,0.1", "X,0.1", f"x,{draws.uniform(1.01, 1e6)}", "x," + "9" * 300]
        for what in wanted:
            status, said = p.ask(f"/do?press={what.replace(' ', '%20')}")
            self.assertEqual(status, 400, (what, said))
        for other in ({"X-Asperity-Token": "0" * 32}, {"X-Asperity-Token": None}, {"X-Asperity-Token": p.token[:-1]},
                      {"Host": "evil.example"}, {"Host": f"evil.example:{p.port}"}, {"Origin": "http://evil.example"}):
            self.assertEqual(p.ask("/do?press=x,0.1", headers=other)[0], 403, other)
            self.assertEqual(p.ask("/panel-state?after=0", "GET", headers=other)[0], 403, other)
        self.assertEqual(p.ask("/do?press=x,0.1", headers={"X-Asperity": None})[0], 404)
        self.assertEqual(p.ask("/do?press=x,0.1", "GET")[0], 404)
        for query in ("after=-1", "after=nan", "after=" + "9" * 40, ""):
            self.assertEqual(p.ask(f"/panel-state?{query}", "GET")[0], 400, query)
        for what in ("beat=,1", "beat=" + "0" * 32 + ",1", "release=" + "0" * 32, "beat=x,1"):
            self.assertEqual(p.ask(f"/do?{what}")[0], 410, what)
        for what in ("beat=x", "beat=x,-1", "beat=x,1e3", "beat=x," + "9" * 40, "pause", "hand=0,0,0,0,0,0,1"):
            self.assertEqual(p.ask(f"/do?{what}")[0], 400, what)
        found = p.end()
        self.assertEqual((found["press_count"], found["largest_force"]), (0, 0.0))

    def test_one_holds_it_and_the_past_is_over(self):
        p = self.panel
        refused = None
        for _ in range(20):  # a busy machine may be late with a beat, which ends a press
            name = p.press()
            most, number = p.hold(name, 0.4)
            begun = time.monotonic()
            if most > 0.4 and p.ask(f"/do?beat={name},{number}")[0] == 204:
                status, said = p.ask("/do?press=y,0.5")
                if time.monotonic() - begun < 0.08:
                    refused = (status, "another page" in said)
                    break
            self.assertTrue(rests(p))
            time.sleep(0.3)
        self.assertEqual(refused, (409, True))
        self.assertEqual(p.ask(f"/do?beat={name},{number - 1}")[0] in (400, 410), True, "an old beat")
        self.assertTrue(rests(p))
        self.assertEqual(p.ask(f"/do?beat={name},{number + 5}")[0], 410)
        self.assertEqual(p.state()["force"], [0, 0, 0])
        again = p.press()
        self.assertNotEqual(again, name)
        self.assertEqual(p.ask(f"/do?beat={name},1000000")[0], 410)
        p.hold(again, 0.3)
        p.ask(f"/do?release={again}")
        self.assertEqual(p.ask(f"/do?beat={again},1000001")[0], 410)
        self.assertTrue(rests(p))
        last = p.press()
        p.hold(last, 0.3)
        found = p.end()
        self.assertFalse(found["armed_at_end"])
        self.assertLessEqual(found["longest_without_beat"], 0.2)
        self.assertLessEqual(found["largest_force"], 0.5 + 1e-9)

    def test_elsewhere_no_force_is_offered(self):
        self.panel.end()
        p = Panel("--view-address", "0.0.0.0")
        p.host = "127.0.0.1"
        try:
            told = json.loads(p.ask("/panel.json", "GET")[1])["force"]
            self.assertFalse(told["offered"])
            self.assertIn("--view-address", told["why_not"])
            status, said = p.ask("/do?press=x,0.5")
            self.assertEqual(status, 403)
            self.assertIn("--view-address", said)
            until = time.monotonic() + 20  # the page is served before the device is found
            while p.state()["device"] != "ready" and time.monotonic() < until:
                time.sleep(0.1)
            self.assertEqual(p.state()["device"], "ready")
        finally:
            self.assertEqual(p.end()["most_force"], 0)


@unittest.skipIf(browser.find()[0] is None, browser.find()[1] or "")
class Page(unittest.TestCase):
    def setUp(self):
        self.panel = Panel()
        self.browser = browser.Browser(browser.find()[0])
        b = self.browser
        b.call("Emulation.setFocusEmulationEnabled", enabled=True)
        b.open(self.panel.url)
        b.wait("asperity.panel?.now && asperity.panel.periods.length > 200")

    def tearDown(self):
        self.browser.close()
        if self.panel.process.poll() is None:
            self.panel.end()

    def at(self):
        return self.browser.value("(() => { const r = document.getElementById('push').getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()")

    def down(self):
        """Presses until it holds: on a busy machine a beat may be late, which ends a press."""
        b = self.browser
        for _ in range(20):
            x, y = self.at()
            b.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
            for _ in range(30):
                time.sleep(0.02)
                if self.panel.state()["force"] != [0, 0, 0] and b.value("document.getElementById('push-state').textContent") == "held":
                    return x, y
            b.mouse("mouseReleased", x, y, button="left", buttons=0, clickCount=1)
        self.fail(b.value("document.getElementById('push-state').textContent"))

    def test_the_page(self):
        b, p = self.browser, self.panel
        # The pose that is shown is the device's: it moves, and goes with what the loop tells.
        def shown():
            return [float(x) for x in re.findall(r"-?[\d.]+", b.value("document.getElementById('position').textContent"))]
        first = shown()
        seen = b.value("asperity.panel.now.position")
        self.assertEqual(len(first), 3)
        b.wait(f"Math.hypot(...asperity.panel.now.position.map((x, i) => x - {seen}[i])) > 1e-3")
        self.assertNotEqual(shown(), first)
        told = b.value("(() => { const n = asperity.panel.now; return [n.position, document.getElementById('position').textContent]; })()")
        for one, other in zip(told[0], re.findall(r"-?[\d.]+", told[1])):
            self.assertAlmostEqual(1e3 * one, float(other), delta=0.006)
        self.assertGreater(b.value("asperity.panel.rate"), 300)
        self.assertGreater(b.value("asperity.panel.jitter"), 0)
        b.wait("document.getElementById('buttons').textContent === '1 pressed'", 10)
        b.wait("document.getElementById('buttons').textContent === 'none pressed'", 10)
        self.assertIn("Hz", b.value("document.getElementById('readout').textContent"))
        self.assertEqual(p.state()["force"], [0, 0, 0])

        # Held by the mouse, then let go.
        x, y = self.down()
        for dark in (False, True):
            b.value(f"document.documentElement.dataset.theme === '{'dark' if dark else 'light'}' || document.getElementById('theme').click()")
            for width, height in ((1280, 720), (390, 844)):
                b.size(width, height)
                time.sleep(0.3)
                b.picture(PICTURES / f"panel-{width}-{'dark' if dark else 'light'}.png")
                self.assertLessEqual(b.value("document.documentElement.scrollWidth"), width, "nothing is cut off")
            self.assertEqual(b.too_little_contrast("h1, h2, p, button, select, label, summary, figcaption, li, th, td, span"), [])
        b.size(1280, 720)
        x, y = self.at()
        b.mouse("mouseReleased", x, y, button="left", buttons=0, clickCount=1)
        self.assertTrue(rests(p))

        # Every way to let go.
        for let_go in ("document.getElementById('push').blur()", "window.dispatchEvent(new Event('blur'))",
                       "window.dispatchEvent(new Event('pagehide'))",
                       "(() => { Object.defineProperty(document, 'visibilityState', { get: () => 'hidden', configurable: true }); "
                       "document.dispatchEvent(new Event('visibilitychange')); delete document.visibilityState; })()"):
            ends = []
            while "released" not in ends and len(ends) < 6:  # a busy machine may lose beats first
                self.down()
                b.value(let_go)
                self.assertTrue(rests(p), let_go)
                ends.append(p.state()["press_end"])
                held = b.value("asperity.panel.held")
                b.mouse("mouseReleased", *self.at(), button="left", buttons=0, clickCount=1)
            self.assertEqual((ends[-1], held), ("released", None), let_go)

        # A key, and a key that repeats.
        b.value("document.getElementById('push').focus()")
        space = {"key": " ", "code": "Space", "windowsVirtualKeyCode": 32}
        b.call("Input.dispatchKeyEvent", type="rawKeyDown", autoRepeat=True, **space)
        time.sleep(0.3)
        self.assertEqual(p.state()["force"], [0, 0, 0], "a key that was down before begins nothing")
        b.call("Input.dispatchKeyEvent", type="keyUp", **space)
        for _ in range(10):
            b.call("Input.dispatchKeyEvent", type="rawKeyDown", **space)
            time.sleep(0.4)
            pushed = p.state()["force"] != [0, 0, 0]
            b.call("Input.dispatchKeyEvent", type="keyUp", **space)
            if pushed:
                break
        self.assertTrue(pushed)
        self.assertTrue(rests(p))
        with_keys = set()
        for _ in range(14):
            b.key("Tab")
            with_keys.add(b.value("document.activeElement.id || document.activeElement.tagName"))
        for wanted in ("axis", "newtons", "push", "events", "theme", "SUMMARY"):
            self.assertIn(wanted, with_keys)

        # Another page has it; this one is told.
        for _ in range(10):
            name = p.press("z,0.25")
            p.hold(name, 0.1)
            x, y = self.at()
            b.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
            _, number = p.hold(name, 0.5, 1000)
            b.mouse("mouseReleased", x, y, button="left", buttons=0, clickCount=1)
            if "another page" in b.value("document.getElementById('push-state').textContent"):
                break
        self.assertIn("another page", b.value("document.getElementById('push-state').textContent"))
        p.ask(f"/do?release={name}")
        self.assertTrue(rests(p))

        # A page whose beats end while its button is held.
        self.down()
        b.value("asperity.panel.beat = () => {}")
        self.assertTrue(rests(p))
        b.mouse("mouseReleased", *self.at(), button="left", buttons=0, clickCount=1)
        complaints = [c for c in b.complaints if "status of 4" not in c]
        self.assertEqual(complaints, [])
        b.open("about:blank")
        found = p.end()
        self.assertIn("lost beats", [r["ended"] for r in found["presses"]])
        self.assertGreater(found["largest_force"], 0.05)
        self.assertLessEqual(found["largest_force"], 1.0)
        self.assertLessEqual(found["longest_without_beat"], 0.2)

    def test_a_browser_that_stands_still(self):
        b, p = self.browser, self.panel
        self.down()
        children = subprocess.run(["pgrep", "-f", b.folder], stdout=subprocess.PIPE, text=True).stdout.split()
        stopped = [int(c) for c in children if int(c) != os.getpid()]
        for c in stopped:
            os.kill(c, signal.SIGSTOP)
        try:
            self.assertTrue(rests(p))
        finally:
            for c in stopped:
                os.kill(c, signal.SIGCONT)
        time.sleep(0.3)
        self.assertEqual(p.state()["force"], [0, 0, 0], "it does not come back by itself")
        found = p.end()
        self.assertEqual(found["presses"][-1]["ended"], "lost beats")
        # A tick of the loop that comes late comes late for this, too.
        self.assertLessEqual(found["presses"][-1]["beat_to_zero"], 0.2 + max(0.0, found["longest_gap"] - 0.02))
        self.assertLessEqual(found["longest_without_beat"], 0.2)

    def test_ctrl_c_while_it_is_held(self):
        self.down()
        found = self.panel.end()
        self.assertFalse(found["armed_at_end"])
        self.assertLessEqual(found["longest_without_beat"], 0.2)


if __name__ == "__main__":
    print(f"seed {SEED}", flush=True)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
