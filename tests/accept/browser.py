"""A headless Chromium, driven through chromedriver by the WebDriver protocol (plain HTTP and JSON; W3C WebDriver 2)."""

import base64
import http.client
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
KEYS = {"Tab": "\ue004", "Enter": "\ue007", "Escape": "\ue00c", "Left": "\ue012", "Up": "\ue013", "Right": "\ue014",
        "Down": "\ue015", "Space": " ", "Home": "\ue011", "End": "\ue010"}
PATIENCE_S = 120  # of one answer: a machine under load is slow, not broken


def missing_programs():
    """What has to be installed, as words; "" when nothing is missing."""
    return " and ".join(name for name in ("chromium", "chromedriver") if shutil.which(name) is None)


class Browser:
    """One window. Every request but file: and data: is refused by the browser's own resolver, and recorded."""

    def __init__(self, width=1400, height=1000):
        self.folder = tempfile.mkdtemp(prefix="pilotage_browser_")
        self.log = open(os.path.join(self.folder, "driver.log"), "w+", encoding="utf-8")
        self.driver = subprocess.Popen([shutil.which("chromedriver"), "--port=0"], stdout=self.log,
                                       stderr=subprocess.STDOUT, start_new_session=True)
        self.session = ""
        try:
            self.port = self._port()
            self._start(width, height)
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _port(self):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            with open(self.log.name, encoding="utf-8") as log:
                found = re.search(r"started successfully on port (\d+)", log.read())
            if found:
                return int(found.group(1))
            if self.driver.poll() is not None:
                break
            time.sleep(0.05)
        raise RuntimeError("chromedriver does not start: " + pathlib.Path(self.log.name).read_text(encoding="utf-8"))

    def _start(self, width, height):
        arguments = ["--headless", "--disable-gpu", "--disable-dev-shm-usage", "--disable-quic", "--no-first-run",
                     "--disable-background-networking", "--disable-component-update", "--disable-sync",
                     "--host-resolver-rules=MAP * ~NOTFOUND", "--force-device-scale-factor=1", "--hide-scrollbars",
                     f"--window-size={width},{height}", f"--user-data-dir={self.folder}/profile"]
        if os.geteuid() == 0:
            arguments.append("--no-sandbox")
        capabilities = {"goog:chromeOptions": {"args": arguments},
                        "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        answer = self._send("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
        self.session = "/session/" + answer["sessionId"]
        self._send("POST", self.session + "/timeouts", {"script": 1000 * PATIENCE_S, "pageLoad": 1000 * PATIENCE_S})

    def _send(self, method, path, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        try:
            connection.request(method, path, json.dumps(body) if body is not None else None,
                               {"Content-Type": "application/json"})
            answer = json.loads(connection.getresponse().read())["value"]
        finally:
            connection.close()
        if isinstance(answer, dict) and "error" in answer and "stacktrace" in answer:
            raise RuntimeError(f"{method} {path}: {answer['error']}: {answer['message']}")
        return answer

    def close(self):
        try:
            if self.session:
                self._send("DELETE", self.session)
        except (OSError, RuntimeError):
            pass
        self.driver.terminate()
        try:
            self.driver.wait(20)
        except subprocess.TimeoutExpired:
            self.driver.kill()
            self.driver.wait()
        self.log.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    # ---- The page ----
    def open(self, path):
        self._send("POST", self.session + "/url", {"url": pathlib.Path(path).resolve().as_uri()})

    def run(self, script, *arguments):
        """The value that the body of a function returns (or that its promise becomes)."""
        return self._send("POST", self.session + "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, script, what, *arguments):
        """Until the script returns something true; that."""
        end = time.monotonic() + PATIENCE_S
        while True:
            value = self.run(script, *arguments)
            if value:
                return value
            if time.monotonic() > end:
                raise RuntimeError(f"waited {PATIENCE_S} s for {what}")
            time.sleep(0.05)

    def devtools(self, command, **parameters):
        """A command of the Chrome DevTools protocol."""
        return self._send("POST", self.session + "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def console(self):
        """What was written to the console since the last call, one text for each message."""
        return [entry["message"] for entry in self._send("POST", self.session + "/se/log", {"type": "browser"})]

    def addresses(self):
        """Every address that was asked for since the last call, shortened."""
        events = [json.loads(entry["message"])["message"]
                  for entry in self._send("POST", self.session + "/se/log", {"type": "performance"})]
        return [event["params"]["request"]["url"][:80] for event in events
                if event["method"] == "Network.requestWillBeSent"]

    # ---- Hands ----
    def pointer(self, actions):
        """Actions of a mouse as the protocol has them."""
        self._send("POST", self.session + "/actions", {"actions": [
            {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}]})

    def move(self, x, y):
        self.pointer([{"type": "pointerMove", "duration": 0, "x": round(x), "y": round(y)}])

    def click(self, x, y):
        self.pointer([{"type": "pointerMove", "duration": 0, "x": round(x), "y": round(y)},
                       {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}])

    def press(self, *keys):
        """Keys by name (KEYS) or letter, to whatever has the focus."""
        actions = []
        for key in keys:
            value = KEYS.get(key, key)
            actions += [{"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}]
        self._send("POST", self.session + "/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    # ---- Eyes ----
    def screenshot(self, path):
        pathlib.Path(path).write_bytes(base64.b64decode(self._send("GET", self.session + "/screenshot")))

    def full_screenshot(self, path):
        size = self.devtools("Page.getLayoutMetrics")["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
        shot = self.devtools("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)
        pathlib.Path(path).write_bytes(base64.b64decode(shot["data"]))

    def pdf(self):
        """The page on paper, as its print style has it."""
        # Not WebDriver's own command, which waits 10 s and no more: a machine under load is slow, not broken.
        return base64.b64decode(self.devtools("Page.printToPDF", preferCSSPageSize=True)["data"])

    def resize(self, width, height):
        """The window's inside. A window itself cannot be as narrow as a phone."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def prefer(self, scheme):
        """What the system is said to prefer: "light" or "dark"."""
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
