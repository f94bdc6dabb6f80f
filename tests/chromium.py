"""A headless Chromium for tests, driven over its DevTools protocol.

It is the machine's own browser; none is fetched.
"""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    *("--headless=new", "--no-sandbox", "--no-first-run", "--remote-debugging-port=0"),
    *("--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
    *("--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader"),
)


class Page:
    """One tab. `errors` and `requests` fill up as the page runs."""

    def __init__(self, width: int = 1280, height: int = 800, patience: float = 60.0) -> None:
        """patience: seconds to wait for any answer."""
        from websockets.sync.client import connect

        assert BROWSER
        self.patience = patience
        self.folder = tempfile.TemporaryDirectory(prefix="aircut-chromium-", ignore_cleanup_errors=True)
        flags = [*FLAGS, f"--user-data-dir={self.folder.name}", f"--window-size={width},{height}"]
        self.process = subprocess.Popen([BROWSER, *flags, "about:blank"], stderr=subprocess.DEVNULL)
        note = Path(self.folder.name, "DevToolsActivePort")
        until = time.monotonic() + patience
        while not (note.exists() and note.read_text().count("\n")):
            if time.monotonic() > until or self.process.poll() is not None:
                raise TimeoutError("Chromium did not start")
            time.sleep(0.05)
        port, path = note.read_text().split("\n")[:2]
        self.stack = ExitStack()
        link = connect(f"ws://127.0.0.1:{port}{path}", max_size=None, proxy=None)
        self.socket = self.stack.enter_context(link)
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.count = 0
        self.session = ""
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.send("Emulation.setDeviceMetricsOverride", **size)

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.stack.close()
        self.process.terminate()
        self.process.wait(10)
        self.folder.cleanup()

    def send(self, method: str, **params: Any) -> Any:
        self.count += 1
        message = {"id": self.count, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        self.socket.send(json.dumps(message))
        while True:
            answer = json.loads(self.socket.recv(timeout=self.patience))
            if answer.get("id") == self.count:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.note(answer.get("method", ""), answer.get("params", {}))

    def note(self, method: str, params: Any) -> None:
        if method == "Runtime.exceptionThrown":
            thrown = params["exceptionDetails"].get("exception", {})
            self.errors.append(thrown.get("description", "exception"))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            self.errors.append(" ".join(str(each.get("value")) for each in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.errors.append(params["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"][:200])

    def run(self, expression: str) -> Any:
        """The value of an expression, awaited if it is a promise."""
        got = self.send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in got:
            raise RuntimeError(got["exceptionDetails"].get("exception", {}).get("description"))
        return got["result"].get("value")

    def open(self, file: Path) -> None:
        """Open a page file and wait until it is ready."""
        self.send("Page.navigate", url=file.resolve().as_uri())
        until = time.monotonic() + self.patience
        while not self.run("document.readyState === 'complete' && 'aircut' in window"):
            if time.monotonic() > until:
                raise TimeoutError(f"page not ready: {self.errors}")
            time.sleep(0.02)
        self.run("aircut.ready")

    def prefer(self, scheme: str) -> None:
        """dark or light."""
        self.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x: float, y: float) -> None:
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y, button="left", clickCount=1)

    def key(self, key: str, code: int) -> None:
        for kind in ("keyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code)

    def picture(self, file: Path) -> None:
        file.write_bytes(base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"]))
