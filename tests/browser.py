"""A headless Chromium, told what to do through two pipes (the DevTools protocol), without any
network.
"""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    *(
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--no-first-run",
        "--remote-debugging-pipe",
        "--hide-scrollbars",
    ),
    *(
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--disable-quic",
        "--disable-extensions",
    ),
    *(
        "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
        "--proxy-server=127.0.0.1:9",
        "--force-color-profile=srgb",
    ),
)
PATIENCE = 20.0
COPIED = (
    "if (navigator.clipboard) navigator.clipboard.writeText = async (text) => { window.copied ="
    " text; };"
)
"""What a page copies is in ``window.copied``: here is no clipboard."""


def found() -> str | None:
    """The browser that there is, or None."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


class Browser:
    """One page of one browser.

    ``complaints`` are errors and warnings of its console, ``asked`` what it tried to load.
    """

    def __init__(self, width: int = 1400, height: int = 900) -> None:
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self._write = os.pipe()
        self._read, to_write = os.pipe()
        flags = [*FLAGS, f"--user-data-dir={self._folder.name}", f"--window-size={width},{height}"]

        def adopt() -> None:
            """Where the browser looks for its pipes: it reads from 3, and writes to 4."""
            high = [fcntl.fcntl(number, fcntl.F_DUPFD, 10) for number in (to_read, to_write)]
            for number, place in zip(high, (3, 4), strict=True):
                os.dup2(number, place)

        quiet = {
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.DEVNULL,
            "stderr": subprocess.DEVNULL,
        }
        self._process = subprocess.Popen(
            [str(found()), *flags], pass_fds=(3, 4), preexec_fn=adopt, **quiet
        )
        os.close(to_read)
        os.close(to_write)
        self._left, self._number, self._session = b"", 0, ""
        self.complaints: list[str] = []
        self.asked: list[str] = []
        try:
            target = self.call("Target.createTarget", url="about:blank")["targetId"]
            self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)[
                "sessionId"
            ]
            for room in ("Page", "Runtime", "Log", "Network"):
                self.call(f"{room}.enable")
            self.size(width, height)
            self.call("Page.addScriptToEvaluateOnNewDocument", source=COPIED)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the browser."""
        self._session = ""
        try:
            self.call("Browser.close")
        except (OSError, RuntimeError):
            self._process.kill()
        self._process.wait(PATIENCE)
        os.close(self._read)
        os.close(self._write)
        self._folder.cleanup()

    def call(self, method: str, **parameters: object) -> dict[str, object]:
        """Ask for something, and wait for the answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while True:
            answer = self._next(end)
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self._hear(answer)

    def open(self, path: Path) -> None:
        """Open a file, and wait until it is there."""
        self.complaints.clear()
        self.asked.clear()
        self.call("Page.navigate", url=path.resolve().as_uri())
        end = time.monotonic() + PATIENCE
        while self.run("document.readyState") != "complete":
            if time.monotonic() > end:
                raise RuntimeError(f"{path} does not open")

    def run(self, expression: str) -> object:
        """What an expression is in the page; a promise is waited for."""
        answer = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description") or details["text"])
        return answer["result"].get("value")

    def run_within(self, expression: str, name: str = "") -> object:
        """What an expression is in the page's frame of a name, which is a page of its own."""
        targets = self.call("Target.getTargets")["targetInfos"]
        frames = [one["targetId"] for one in targets if one["type"] == "iframe"]
        own = self._session
        try:
            for frame in frames:
                found = self.call("Target.attachToTarget", targetId=frame, flatten=True)
                self._session = found["sessionId"]
                if self.run("window.name") == name:
                    return self.run(expression)
                self._session = own
        finally:
            self._session = own
        raise RuntimeError(f"no frame '{name}' among {len(frames)}")

    def size(self, width: int, height: int, scale: float = 1.0, mobile: bool = False) -> None:
        """Give the page a size."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=scale,
            mobile=mobile,
        )

    def prefer(self, **features: str) -> None:
        """Say what the user of the browser prefers, such as ``prefers-color-scheme``."""
        told = [
            {"name": name.replace("_", "-"), "value": value} for name, value in features.items()
        ]
        self.call("Emulation.setEmulatedMedia", features=told)

    def press(self, key: str, text: str = "") -> None:
        """Press a key."""
        code = {
            "key": key,
            "code": key,
            "windowsVirtualKeyCode": {"ArrowRight": 39, "ArrowLeft": 37, " ": 32}.get(key, 0),
        }
        self.call("Input.dispatchKeyEvent", type="keyDown", text=text, **code)
        self.call("Input.dispatchKeyEvent", type="keyUp", **code)

    def point(self, x: float, y: float, kind: str = "mouseMoved", **more: object) -> None:
        """Move the mouse, or with a kind press and release it."""
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def picture(self, path: Path, whole: bool = False) -> None:
        """What the page looks like, as PNG."""
        answer = self.call("Page.captureScreenshot", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(str(answer["data"])))

    def printed(self, path: Path, width: float = 8.27, height: float = 11.69) -> bytes:
        """The page on paper [inch], as PDF."""
        answer = self.call(
            "Page.printToPDF",
            printBackground=True,
            paperWidth=width,
            paperHeight=height,
            preferCSSPageSize=False,
        )
        content = base64.b64decode(str(answer["data"]))
        path.write_bytes(content)
        return content

    def _next(self, end: float) -> dict[str, object]:
        while b"\0" not in self._left:
            ready, _, _ = select.select([self._read], [], [], max(0.0, end - time.monotonic()))
            part = os.read(self._read, 1 << 20) if ready else b""
            if not part:
                raise RuntimeError("the browser does not answer")
            self._left += part
        message, _, self._left = self._left.partition(b"\0")
        return json.loads(message)

    def _hear(self, event: dict[str, object]) -> None:
        told = event.get("params", {})
        method = event.get("method")
        if method == "Runtime.exceptionThrown":
            self.complaints.append(
                told["exceptionDetails"].get("exception", {}).get("description") or str(told)
            )
        elif method == "Runtime.consoleAPICalled" and told["type"] in (
            "error",
            "warning",
            "assert",
        ):
            self.complaints.append(str([one.get("value") for one in told["args"]]))
        elif method == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
            self.complaints.append(told["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.asked.append(told["request"]["url"])
