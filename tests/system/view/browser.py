"""A headless Chromium, driven over its debugging protocol."""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import urllib.request


def find():
    """Path of a Chromium and None, or None and what is missing."""
    program = next((p for p in map(shutil.which, ("chromium", "chromium-browser")) if p), None)
    if program is None:
        return None, "there is no chromium (Debian: chromium)"
    try:
        import websocket  # noqa: F401
    except ImportError:
        return None, "there is no websocket module (Debian: python3-websocket)"
    return program, None


CONTRAST = r"""(() => {
  const light = (c) => { const [r, g, b] = c.map((v) => { v /= 255; return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const parse = (t) => { const n = t.match(/[\d.]+/g).map(Number); return { rgb: n.slice(0, 3), a: n.length > 3 ? n[3] : 1 }; };
  const behind = (e) => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor); if (c.a > 0.99) return c.rgb; } return [255, 255, 255]; };
  const bad = [];
  for (const e of document.querySelectorAll(WANTED)) {
    if (e.textContent.trim() === '' || e.offsetParent === null || e.disabled) continue;
    const [a, b] = [light(parse(getComputedStyle(e).color).rgb), light(behind(e))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) bad.push(e.tagName + ' ' + e.textContent.trim().slice(0, 20) + ' ' + ratio.toFixed(2));
  }
  return bad;
})()"""


class Browser:
    """One page at a time; errors of its scripts are kept in `complaints`."""

    def __init__(self, program, width=1280, height=720):
        self.folder = tempfile.mkdtemp(prefix="asperity-browser-")
        self.process = subprocess.Popen(
            [program, "--headless=new", "--remote-debugging-port=0", "--no-first-run", "--no-sandbox",
             "--disable-background-networking", "--disable-dev-shm-usage", f"--user-data-dir={self.folder}", "--hide-scrollbars",
             "--remote-allow-origins=*", "--enable-unsafe-swiftshader", f"--window-size={width},{height}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.complaints = []
        self.number = 0
        self.socket = self._connect()
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.size(width, height)

    def _connect(self):
        import websocket
        told = pathlib.Path(self.folder) / "DevToolsActivePort"
        until = time.monotonic() + 60
        while time.monotonic() < until:
            try:
                port = int(told.read_text().split()[0])
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=10) as answer:
                    pages = [p for p in json.load(answer) if p["type"] == "page"]
                if pages:
                    return websocket.create_connection(pages[0]["webSocketDebuggerUrl"], timeout=60,
                                                       suppress_origin=True)
            except (OSError, ValueError, IndexError):
                pass
            time.sleep(0.05)
        raise RuntimeError("chromium did not start")

    def close(self):
        self.socket.close()
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def call(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.recv())
            self._keep(message)
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]

    def _keep(self, message):
        method, parameters = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.complaints.append(f"{parameters['entry']['text']} {parameters['entry'].get('url', '')}".strip())
        elif method == "Network.requestWillBeSent":
            self.requests = getattr(self, "requests", [])
            self.requests.append(parameters["request"]["url"])

    def size(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 500)

    def dark(self, wanted):
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if wanted else "light"}])

    def open(self, url):
        self.call("Page.navigate", url=url)

    def value(self, expression):
        """What an expression of the page is; a promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", str(answer)))
        return answer["result"].get("value")

    def wait(self, expression, seconds=30):
        """Waits until an expression is true. Returns the seconds that it took."""
        begin = time.monotonic()
        while time.monotonic() < begin + seconds:
            try:
                if self.value(f"Boolean({expression})"):
                    return time.monotonic() - begin
            except RuntimeError:
                pass  # the page is not there yet
            time.sleep(0.03)
        raise RuntimeError(f"not true within {seconds} s: {expression}; the page says: {self.complaints}")

    def key(self, name, text=None, modifiers=0):
        more = {"text": text} if text else {}
        codes = {"Tab": 9, "Enter": 13, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, " ": 32}
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, modifiers=modifiers,
                      windowsVirtualKeyCode=codes.get(name, ord(name[0].upper())), **(more if kind == "keyDown" else {}))

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def too_little_contrast(self, elements):
        """The texts of these elements, a selector, that stand out too little from what is behind them (AA)."""
        return self.value(CONTRAST.replace("WANTED", json.dumps(elements)))

    def picture(self, file):
        shot = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        if file:
            os.makedirs(os.path.dirname(file) or ".", exist_ok=True)
            pathlib.Path(file).write_bytes(shot)
        return shot
