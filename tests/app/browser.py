"""Headless Chromium steered through its DevTools protocol, so that a test sees a page as a reader does.

The protocol runs over a pair of pipes (`--remote-debugging-pipe`: JSON texts that end in a zero byte), which needs no
port and no package.
"""

import base64
import contextlib
import itertools
import json
import os
import select
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium (Debian: chromium)")
TO_BROWSER, FROM_BROWSER = 3, 4  # file descriptors, fixed by Chromium
PATIENCE = 60.0  # s without a word


class Tab:
    """One page; what it asked the network for and what it complained of are kept."""

    def __init__(self, line: "Line", session: str) -> None:
        self._line = line
        self._session = session
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.shows: Path | None = None
        self._loaded = False

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """Call a method of the protocol and return its result."""
        return self._line.send(method, params, self._session)

    def notice(self, method: str, params: dict[str, Any]) -> None:
        """Take an event of the page."""
        if method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(params["exceptionDetails"]["exception"].get("description", "an exception"))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.complaints.append(f"console: {params['args']}")
        elif method == "Log.entryAdded":
            self.complaints.append(params["entry"]["text"])
        elif method == "Page.loadEventFired":
            self._loaded = True

    def look(self, *, width: int, height: int = 900, dark: bool = False) -> None:
        """Set the window [CSS pixels] and the colour scheme."""
        self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 500
        )
        features = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.call("Emulation.setEmulatedMedia", media="", features=features)

    def open(self, path: Path, *, fragment: str = "", scripts: bool = True, wait: str = "rotorReport.drawn") -> None:
        """Open a page anew and wait until it is loaded and, with scripts, its promise `wait` is kept: plots are drawn.

        `fragment` is what stands behind # in its address.
        """
        self.call("Emulation.setScriptExecutionDisabled", value=not scripts)
        if fragment:
            self._go("about:blank")  # a change behind # alone opens nothing
        self.requests.clear()
        self.complaints.clear()
        self._go(path.as_uri() + (f"#{fragment}" if fragment else ""))
        self.shows = path if scripts else None
        if scripts:
            self.run(wait)

    def _go(self, address: str) -> None:
        """Open an address and wait until it is loaded."""
        self._loaded = False
        self.call("Page.navigate", url=address)
        while not self._loaded:
            self._line.listen()

    def run(self, script: str) -> Any:
        """Return the value of an expression in the page, a promise's once it is kept."""
        done = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def press(self, key: str) -> None:
        """Press and release a key that types nothing: "Tab", say."""
        number = {"Tab": 9, "Enter": 13, " ": 32, "ArrowLeft": 37}[key]
        text = {"text": "\r"} if key == "Enter" else {}  # without which it presses no button
        for kind in ("keyDown" if text else "rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=number, **text)

    def picture(self, path: Path, selector: str = "body", *, scale: float = 1.0) -> None:
        """Write the first element that a CSS selector finds as a PNG, of so many pixels for one of CSS."""
        script = f"JSON.stringify(document.querySelector({json.dumps(selector)}).getBoundingClientRect())"
        box = json.loads(self.run(script))
        clip = {key: box[key] for key in ("x", "y", "width", "height")} | {"scale": scale}
        shot = self.call("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))

    def paper(self, *, width: float, height: float) -> bytes:
        """Return the page as a PDF on paper of this size [inch]."""
        done = self.call("Page.printToPDF", paperWidth=width, paperHeight=height, preferCSSPageSize=False)
        return base64.b64decode(done["data"])


@contextlib.contextmanager
def browser(profile: Path) -> Iterator[Tab]:
    """Start Chromium with an empty profile and yield its one tab; it ends with the `with` block."""
    to_read, to_write = os.pipe()
    from_read, from_write = os.pipe()
    words = [str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"]
    words += ["--disable-background-networking", "--disable-component-update", "--disable-extensions"]
    words += ["--hide-scrollbars"]  # which go when a picture is taken, and the page moves
    words += [f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"]
    # a shell puts the ends where Chromium looks for them; the numbers they have here may be any
    shell = f'exec "$@" {TO_BROWSER}<&{to_read} {FROM_BROWSER}>&{from_write}'
    process = subprocess.Popen(
        ["bash", "-c", shell, "bash", *words],
        pass_fds=(to_read, from_write),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(to_read)
    os.close(from_write)
    try:
        with os.fdopen(to_write, "wb") as out, os.fdopen(from_read, "rb") as back:
            line = Line(out, back)
            yield line.tab()
            with contextlib.suppress(EOFError, OSError):
                line.send("Browser.close", {})
    finally:
        process.terminate()
        process.wait(timeout=10)


class Line:
    """The two pipes: commands go out, answers and events come back in one stream."""

    def __init__(self, out: Any, back: Any) -> None:
        self._out = out
        self._back = back
        self._numbers = itertools.count(1)
        self._tabs: dict[str, Tab] = {}
        self._kept = b""

    def tab(self) -> Tab:
        """Return the tab that the browser opened by itself."""
        (page, *_) = [t for t in self.send("Target.getTargets", {})["targetInfos"] if t["type"] == "page"]
        session = self.send("Target.attachToTarget", {"targetId": page["targetId"], "flatten": True})["sessionId"]
        tab = self._tabs[session] = Tab(self, session)
        for domain in ("Page", "Runtime", "Network", "Log"):
            tab.call(f"{domain}.enable")
        return tab

    def send(self, method: str, params: dict[str, Any], session: str = "") -> dict[str, Any]:
        """Send a command and return the result in its answer; events that come before it go to their tab."""
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": params} | ({"sessionId": session} if session else {})
        self._out.write(json.dumps(message).encode() + b"\0")
        self._out.flush()
        while (answer := self.listen()).get("id") != number:
            pass
        assert "error" not in answer, f"{method}: {answer['error']}"
        result: dict[str, Any] = answer["result"]
        return result

    def listen(self) -> dict[str, Any]:
        """Wait for the next message and return it, a tab's event handed on."""
        while b"\0" not in self._kept:
            if not select.select([self._back], [], [], PATIENCE)[0]:
                raise TimeoutError(f"Chromium said nothing for {PATIENCE:g} s")
            piece = os.read(self._back.fileno(), 1 << 20)
            if not piece:
                raise EOFError("Chromium ended")
            self._kept += piece
        text, _, self._kept = self._kept.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        if "method" in message and (tab := self._tabs.get(message.get("sessionId", ""))):
            tab.notice(message["method"], message["params"])
        return message
