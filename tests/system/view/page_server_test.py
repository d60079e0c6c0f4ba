#!/usr/bin/python3
"""The live page's server, asked by clients that behave and by clients that do not. ASPERITY PROBE FIXED."""
import json
import math
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import time
import unittest
import warnings

EXE, PROBE, FIXED = sys.argv[1:4]
SEED = int.from_bytes(os.urandom(4), "little") if "ASPERITY_SEED" not in os.environ else int(os.environ["ASPERITY_SEED"])
FUZZED = 10 * (300 if os.environ.get("ASPERITY_AT_LENGTH") else 30)


class Session:
    """A session with a page; `url` is where."""

    def __init__(self, *more, seconds="60", view=("--view", "0")):
        self.process = subprocess.Popen(
            [EXE, "run", "--probe", PROBE, "--fixed", FIXED, "--seconds", seconds, "--json", *view, *more],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url = None
        self.said = []
        while view and self.url is None:
            line = self.process.stderr.readline()
            if line == "":
                raise AssertionError(f"the session ended: {self.said}")
            self.said.append(line)
            found = re.search(r"http://([0-9.]+):([0-9]+)/(?:#token=([0-9a-f]+))?", line)
            if found:
                self.url, self.host, self.port, self.token = found[0], found[1], int(found[2]), found[3]

    def end(self):
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=30)
        return json.loads(out)

    def connect(self, timeout=20):
        return socket.create_connection((self.host, self.port), timeout)

    def ask(self, path, method="GET", headers=(), host=None):
        host = host or f"{self.host}:{self.port}"
        lines = [f"{method} {path} HTTP/1.1", f"Host: {host}", *headers]
        with self.connect() as s:
            s.sendall(("\r\n".join(lines) + "\r\n\r\n").encode("latin-1"))
            return read_all(s)


def is_whole(out):
    head, gap, body = out.partition(b"\r\n\r\n")
    length = re.search(rb"\r\nContent-Length: (\d+)", head)
    return bool(gap and length) and len(body) >= int(length[1])


# Not until the server hangs up: it does so at once, and what a busy machine has not read by then is gone.
def read_all(s):
    out = b""
    while not is_whole(out):
        try:
            more = s.recv(1 << 16)
        except ConnectionResetError:
            more = b""
        if not more:
            break
        out += more
    head, _, body = out.partition(b"\r\n\r\n")
    words = head.split()
    return int(words[1]) if len(words) > 1 and words[1].isdigit() else 0, head.decode("latin-1"), body


def rows_of(frame):
    magic, rows = frame[:4], struct.unpack_from("<I", frame, 4)[0]
    assert magic == b"ASPF", magic
    following, missed = struct.unpack_from("<dd", frame, 32)
    times = struct.unpack_from(f"<{rows}d", frame, 56)
    return int(following), int(missed), times


def newest(session, columns, name, count):
    """Some values of the newest row."""
    while True:
        frame = session.ask("/frame?after=0")[2]
        rows = struct.unpack_from("<I", frame, 4)[0]
        if rows > 0:
            at = 56 + 8 * rows + 4 * (len(columns) * (rows - 1) + columns.index(name))
            return struct.unpack_from(f"<{count}f", frame, at)


class PageServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.session = Session()

    @classmethod
    def tearDownClass(cls):
        document = cls.session.end()
        assert document["schema"] == "asperity.run/1", document

    def answers(self):
        code, _, body = self.session.ask("/scene.json")
        self.assertEqual(code, 200)
        return json.loads(body)

    def test_tells_the_scene_and_every_tick_once(self):
        scene = self.answers()
        self.assertEqual(scene["mode"], "live")
        self.assertEqual(self.session.ask("/mesh/0")[2][:4], b"ASPM")
        after, all_times = 0, []
        for _ in range(20):
            after, missed, times = rows_of(self.session.ask(f"/frame?after={after}")[2])
            if all_times:
                self.assertEqual(missed, 0)
            all_times += times
            time.sleep(0.02)
        self.assertGreater(len(all_times), 100)
        for a, b in zip(all_times, all_times[1:]):
            self.assertAlmostEqual(b - a, 1e-3, places=9)

    def test_a_page_that_was_away_is_told_what_it_missed(self):
        own = ["X-Asperity: 1"]
        self.assertEqual(self.session.ask("/do?speed=10", "POST", own)[0], 204)
        after, missed, times, until = 0, 0, (), time.monotonic() + 60
        while missed == 0 and time.monotonic() < until:
            time.sleep(0.2)
            after, missed, times = rows_of(self.session.ask("/frame?after=1")[2])
        self.session.ask("/do?speed=1", "POST", own)
        self.assertGreater(missed, 0)
        self.assertEqual(1 + missed + len(times), after)
        begin = rows_of(self.session.ask(f"/frame?after={after}")[2])
        self.assertEqual(begin[1], 0)
        # Rows are a millisecond apart: the first that came is as far from the one after the last as their numbers are.
        if begin[2]:
            self.assertAlmostEqual(begin[2][0] - times[0], 1e-3 * (after - 1 - missed), places=9)

    def test_every_answer_forbids_foreign_content(self):
        for path in ("/", "/page.js", "/scene.json", "/nothing"):
            _, head, _ = self.session.ask(path)
            policy = re.search(r"Content-Security-Policy: (.*)", head)[1]
            self.assertIn("default-src 'none'", policy)
            self.assertNotIn("unsafe", policy)
            self.assertNotIn("Set-Cookie", head)
        page = self.session.ask("/")[2].decode()
        self.assertNotRegex(page, r"<script(?![^>]*\ssrc=)|\son[a-z]+=|style=|https?://")

    def test_a_foreign_page_is_refused(self):
        self.assertEqual(self.session.ask("/scene.json", host="evil.example:80")[0], 403)
        self.assertEqual(self.session.ask("/scene.json", headers=["Origin: http://evil.example"])[0], 403)
        self.assertEqual(self.session.ask("/do?pause", "POST")[0], 404, "without the page's own header")
        own = f"Origin: http://127.0.0.1:{self.session.port}"
        self.assertEqual(self.session.ask("/scene.json", headers=[own])[0], 200)

    def test_no_file_of_the_machine_is_reached(self):
        for path in ("/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%2f..%2fetc/passwd", "//etc/passwd",
                     "/mesh/../../etc/passwd", "/mesh/-1", "/mesh/2", "/rows/0", "/rows/-1", "/session.json", "/mesh/1000000", "/mesh/99999999999999999999", "/mesh/1e0", "/page.js/../../x",
                     "/%00", "/mesh/0%00", "/\xff\xfe", "/frame?after=-1", "/frame?after=1;x", "/frame"):
            code, _, body = self.session.ask(path)
            self.assertIn(code, (0, 400, 404), path)
            self.assertNotIn(b"root:", body)
        for method in ("PUT", "DELETE", "OPTIONS", "PROPFIND", "TRACE", "\xff"):
            self.assertIn(self.session.ask("/page.js", method)[0], (0, 400, 403, 405, 501), method)
        # Civetweb would answer a WebSocket by itself: nothing here takes one, so nobody can send it a frame.
        upgrade = ["Upgrade: websocket", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="]
        self.assertNotEqual(self.session.ask("/frame?after=0", headers=upgrade)[0], 101)
        self.answers()

    def test_pause_step_and_speed(self):
        own = ["X-Asperity: 1"]
        self.assertEqual(self.session.ask("/do?pause", "POST", own)[0], 204)
        time.sleep(0.1)
        after, _, _ = rows_of(self.session.ask("/frame?after=0")[2])
        again, _, _ = rows_of(self.session.ask(f"/frame?after={after}")[2])
        self.assertEqual(again, after, "a paused session makes no ticks")
        self.assertEqual(self.session.ask("/do?step=3", "POST", own)[0], 204)
        time.sleep(0.3)
        stepped, _, _ = rows_of(self.session.ask(f"/frame?after={after}")[2])
        self.assertEqual(stepped, after + 3)
        for wrong in ("speed=0", "speed=nan", "speed=1e9", "step=0", "step=99999", "step=-1", "quit", ""):
            self.assertEqual(self.session.ask(f"/do?{wrong}", "POST", own)[0], 400, wrong)
        self.assertEqual(self.session.ask("/do?resume", "POST", own)[0], 204)
        time.sleep(0.3)
        self.assertGreater(rows_of(self.session.ask(f"/frame?after={stepped}")[2])[0], stepped)

    def test_a_hand_is_led_where_it_was_asked_for(self):
        asks = ["X-Asperity: 1"]
        self.assertEqual(self.session.ask("/do?hand=0,0,0.1,0,0,0,1", "POST", asks)[0], 404)
        led = Session("--motion", "mouse")
        try:
            scene = json.loads(led.ask("/scene.json")[2])
            self.assertTrue(scene["leads"])
            x, y, z = newest(led, scene["columns"], "target_x", 3)
            for bad in ("", "1,2,3", "0,0,0.1,0,0,0,1,", "0,0,0.1,0,0,0,1,2", "0,0,0.1,0,0,0,2", "0,0,0.1,0,0,0,0",
                        "nan,0,0,0,0,0,1", "0,0,inf,0,0,0,1", "0,0,11,0,0,0,1", "0,0,0.1,0,0,0,1x", "a,b,c,d,e,f,g", "0,,0,0,0,0,1"):
                self.assertEqual(led.ask(f"/do?hand={bad}", "POST", asks)[0], 400, bad)
            self.assertEqual(led.ask("/do?hand=0,0,0.1,0,0,0,1", "POST")[0], 404, "without the page's own header")
            time.sleep(0.3)
            self.assertLess(math.dist(newest(led, scene["columns"], "target_x", 3), (x, y, z)), 3e-4, "nobody has led it")
            wanted = (x + 0.004, y - 0.003, z + 0.02)
            asked = ",".join(str(n) for n in (*wanted, 0, 0, 0.6, 0.8))
            self.assertEqual(led.ask(f"/do?hand={asked}", "POST", asks)[0], 204)
            until = time.monotonic() + 60
            while True:
                place = newest(led, scene["columns"], "target_x", 3)
                turn = newest(led, scene["columns"], "target_qx", 4)
                if math.dist(place, wanted) < 3e-4 and math.dist(turn, (0, 0, 0.6, 0.8)) < 0.005:
                    break
                self.assertLess(time.monotonic(), until, f"the hand did not come: {place}, {turn}")
                time.sleep(0.05)
        finally:
            led.end()

    def test_pages_that_stall_leave_or_dawdle_hold_nobody_up(self):
        stalled = []
        for _ in range(4):  # asks for much and reads nothing
            s = self.session.connect()
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.sendall(f"GET /mesh/0 HTTP/1.1\r\nHost: 127.0.0.1:{self.session.port}\r\n\r\n".encode())
            stalled.append(s)
        for _ in range(8):  # leaves in the middle of an answer
            s = self.session.connect()
            s.sendall(f"GET /mesh/0 HTTP/1.1\r\nHost: 127.0.0.1:{self.session.port}\r\n\r\n".encode())
            s.recv(100)
            s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            s.close()
        slow = [self.session.connect() for _ in range(40)]  # a letter at a time
        for s in slow:
            s.sendall(b"GET / HT")
        time.sleep(3)
        self.answers()
        for s in stalled + slow:
            s.close()

    def test_huge_requests_are_cut_off(self):
        for huge in (b"GET /" + b"a" * 1_000_000, b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 100_000,
                     f"POST /do?pause HTTP/1.1\r\nHost: 127.0.0.1:{self.session.port}\r\nX-Asperity: 1\r\n"
                     "Content-Length: 99999999999\r\n\r\n".encode() + b"z" * 1_000_000):
            with self.session.connect() as s:
                try:
                    s.sendall(huge)
                    code, _, _ = read_all(s)
                except (BrokenPipeError, ConnectionResetError):
                    code = 0
                self.assertNotIn(code, (200, 204))
        self.answers()
        with open(f"/proc/{self.session.process.pid}/status", encoding="ascii") as status:
            resident = int(re.search(r"VmRSS:\s+(\d+)", status.read())[1])
        self.assertLess(resident, 2_000_000, "kB")

    def test_bytes_at_random(self):
        print(f"ASPERITY_SEED={SEED}")
        draw = random.Random(SEED)
        good = f"GET /frame?after=0 HTTP/1.1\r\nHost: 127.0.0.1:{self.session.port}\r\nConnection: close\r\n\r\n".encode()
        for _ in range(FUZZED):
            bytes_now = bytearray(good)
            for _ in range(draw.randint(1, 12)):
                at = draw.randrange(len(bytes_now))
                bytes_now[at:at + draw.randint(0, 3)] = draw.randbytes(draw.randint(0, 4))
            with self.session.connect() as s:
                try:
                    s.sendall(bytes_now)
                    s.shutdown(socket.SHUT_WR)
                    read_all(s)
                except OSError:
                    pass  # the server has hung up
        self.answers()


class Ports(unittest.TestCase):
    @staticmethod
    def listening(pid):
        names = set()
        for name in os.listdir(f"/proc/{pid}/fd"):
            try:
                found = re.match(r"socket:\[(\d+)\]", os.readlink(f"/proc/{pid}/fd/{name}"))
            except OSError:
                continue
            if found:
                names.add(found[1])
        out = []
        for table in ("tcp", "tcp6", "udp", "udp6"):
            try:
                with open(f"/proc/{pid}/net/{table}", encoding="ascii") as lines:
                    out += [w[1] for w in map(str.split, lines) if len(w) > 9 and w[9] in names]
            except OSError:
                pass
        return out

    def test_nothing_listens_unless_asked(self):
        quiet = Session("--clock", "real", seconds="20", view=())
        time.sleep(1)
        self.assertEqual(self.listening(quiet.process.pid), [])
        quiet.end()
        shown = Session()
        self.assertTrue(all(a.startswith("0100007F:") for a in self.listening(shown.process.pid)))
        self.assertNotEqual(self.listening(shown.process.pid), [], "the search is broken")
        shown.end()

    def test_another_address_needs_the_token(self):
        open_session = Session("--view-address", "0.0.0.0")
        self.assertRegex(open_session.token or "", r"^[0-9a-f]{32}$")
        ask = open_session.ask
        self.assertEqual(ask("/")[0], 200)
        for path in ("/scene.json", "/mesh/0", "/rows/0", "/session.json", "/frame?after=0"):
            self.assertEqual(ask(path)[0], 403, path)
            other = [t[:at] + ("1" if t[at] == "0" else "0") + t[at + 1:] for t in [open_session.token] for at in (0, 16, 31)]
            for wrong in ("", "0" * 32, open_session.token[:-1], open_session.token + "0", *other):
                self.assertEqual(ask(path, headers=[f"X-Asperity-Token: {wrong}"])[0], 403)
            right = ask(path, headers=[f"X-Asperity-Token: {open_session.token}"])[0]
            self.assertEqual(right, 404 if path in ("/rows/0", "/session.json") else 200, "a session has no recording and no list")
        self.assertEqual(ask("/do?pause", "POST", ["X-Asperity: 1"])[0], 403)
        open_session.end()

    def test_a_taken_port_is_said(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            with self.assertRaisesRegex(AssertionError, "another program may have the port"):
                Session(view=("--view", str(taken.getsockname()[1])))


if __name__ == "__main__":
    warnings.simplefilter("ignore", ResourceWarning)
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
