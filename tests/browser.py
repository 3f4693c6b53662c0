"""Look at pages with a real browser, where the machine has one."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import time
from base64 import b64decode
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from html import unescape
from pathlib import Path
from typing import IO, Any

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_chromium = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium on this machine (Debian: apt install chromium)"
)

# Nothing that the browser does of its own accord, such as looking for updates.
QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
)

POLICY = "default-src 'none'"
SCRIPT = """<script>
addEventListener("load", () => {
  const all = (selector) => [...document.querySelectorAll(selector)];
  const seen = {
    anchors: all("[id]").map((one) => one.id),
    lost_links: all("a[href^='#']").map((one) => one.hash.slice(1)).filter((id) => !document.getElementById(id)),
    images: all("img").length,
    broken_images: all("img").filter((one) => !one.complete || one.naturalWidth === 0).map((one) => one.alt),
    silent_images: all("img:not([alt]), img[alt='']").length,
    fetched: performance.getEntriesByType("resource").map((one) => one.name).filter((one) => !/^data:/.test(one)),
    width: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  };
  const told = document.createElement("pre");
  told.id = "told-by-the-test";
  told.textContent = JSON.stringify(seen);
  document.body.append(told);
});
</script>"""


@dataclass(frozen=True)
class Seen:
    """What a browser made of a page.

    Attributes:
        anchors: The ids of its elements.
        lost_links: Links within the page that lead nowhere.
        images: How many there are.
        broken_images: The alternative texts of images that were not shown.
        silent_images: How many images have no alternative text.
        fetched: What was asked for over a network, whether it came or not.
        width: Pixels by which the page is wider than the window.
    """

    anchors: list[str]
    lost_links: list[str]
    images: int
    broken_images: list[str]
    silent_images: int
    fetched: list[str]
    width: int


def look(page: Path, folder: Path, window: str = "1300,900") -> Seen:
    """Open a copy of a page in Chromium, with a script that looks around and which the copy's policy allows.

    Args:
        page: The page.
        folder: An empty folder for the copy and the browser's profile.
        window: Width, height in pixels.
    """
    assert CHROMIUM is not None
    text = page.read_text(encoding="utf-8")
    copy = folder / "looked_at.html"
    copy.write_text(
        text.replace(POLICY, f"{POLICY}; script-src 'unsafe-inline'").replace("</body>", f"{SCRIPT}</body>"),
        encoding="utf-8",
    )
    return Seen(**json.loads(_told(dom(copy, folder / "profile", window))))


def dom(page: Path, profile: Path, window: str = "1300,900") -> str:
    """The page's document as Chromium sees it when all is loaded."""
    assert CHROMIUM is not None
    options = [*QUIET, f"--user-data-dir={profile}", f"--window-size={window}", "--dump-dom"]
    options.append("--virtual-time-budget=10000")
    done = subprocess.run(
        [CHROMIUM, *options, page.as_uri()], capture_output=True, text=True, check=True, timeout=120
    )
    return done.stdout


def _told(document: str) -> str:
    found = re.search(r'<pre id="told-by-the-test">(.*?)</pre>', document, re.DOTALL)
    assert found is not None, f"the script did not run: {document[-500:]}"
    return unescape(found[1])


def use(page: Path, scripts: list[str], folder: Path) -> list[Any]:
    """Open a page and run scripts on it, one after the other; files that it saves go to the folder.

    Args:
        page: The page.
        scripts: Expressions of JavaScript.
        folder: Where files are saved; the browser's profile is a folder in it, too.

    Returns:
        The value of each script, or the path of the file that was saved where a script is `DOWNLOADED`, which waits
        for one.
    """
    with _remote(folder / "profile") as browser:
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        browser.call(
            "Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder.resolve()), eventsEnabled=True
        )
        browser.call("Page.enable", session)
        browser.call("Page.navigate", session, url=page.resolve().as_uri())
        browser.wait("Page.loadEventFired")
        values: list[Any] = []
        for script in scripts:
            if script == DOWNLOADED:
                name = browser.wait("Browser.downloadWillBegin")["suggestedFilename"]
                while browser.wait("Browser.downloadProgress")["state"] != "completed":
                    pass
                values.append(folder / name)
            else:
                done = browser.call("Runtime.evaluate", session, expression=script, returnByValue=True)
                assert "exceptionDetails" not in done, done
                values.append(done["result"].get("value"))
        return values


DOWNLOADED = "(wait for a file to be saved)"


class _Browser:
    """Speaks the Chrome DevTools Protocol: JSON texts that end with a zero byte."""

    def __init__(self, commands: IO[bytes], answers: IO[bytes]) -> None:
        self._commands, self._answers = commands, answers
        self._events: list[dict[str, Any]] = []
        self._sent = 0

    def call(self, method: str, session: str | None = None, **params: object) -> dict[str, Any]:
        self._sent += 1
        command = {"id": self._sent, "method": method, "params": params} | ({"sessionId": session} if session else {})
        self._commands.write(json.dumps(command).encode() + b"\0")
        self._commands.flush()
        while (answer := self._read()).get("id") != self._sent:
            self._events.append(answer)
        assert "error" not in answer, (method, answer)
        result: dict[str, Any] = answer["result"]
        return result

    def wait(self, event: str) -> dict[str, Any]:
        while True:
            told = self._events.pop(0) if self._events else self._read()
            if told.get("method") == event:
                params: dict[str, Any] = told["params"]
                return params

    def _read(self) -> dict[str, Any]:
        text = b""
        while not text.endswith(b"\0"):
            one = self._answers.read(1)
            assert one, "the browser has gone"
            text += one
        answer: dict[str, Any] = json.loads(text[:-1])
        return answer


class Tab:
    """A page of a server, with which a test does what people do."""

    def __init__(self, browser: _Browser, url: str, width: int = 1200, height: int = 900) -> None:
        self._browser = browser
        self._target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = browser.call("Target.attachToTarget", targetId=self._target, flatten=True)["sessionId"]
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        browser.call("Emulation.setDeviceMetricsOverride", self._session, **size)
        browser.call("Page.enable", self._session)
        browser.call("Page.navigate", self._session, url=url)

    def run(self, script: str) -> Any:
        """The value of an expression of JavaScript."""
        done = self._browser.call("Runtime.evaluate", self._session, expression=script, returnByValue=True)
        assert "exceptionDetails" not in done, done
        return done["result"].get("value")

    def until(self, script: str, patience: float = 40.0) -> Any:
        """The value of an expression, as soon as it is true of the page."""
        end = time.monotonic() + patience
        while not (value := self.run(script)):
            assert time.monotonic() < end, (script, self.run("document.body.innerText"))
            time.sleep(0.05)
        return value

    def type(self, text: str) -> None:
        """Type a text into what has the focus."""
        self._browser.call("Input.insertText", self._session, text=text)

    def press(self, key: str, code: int, text: str = "") -> None:
        """Press a key; `code` is the one of Windows."""
        more = {"text": text} if text else {}
        for kind in ("keyDown", "keyUp"):
            params = {"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code}
            self._browser.call("Input.dispatchKeyEvent", self._session, **params | more)

    def picture(self) -> bytes:
        """The whole page as PNG."""
        width, height = self.run("[innerWidth, document.documentElement.scrollHeight]")
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
        taken = self._browser.call("Page.captureScreenshot", self._session, captureBeyondViewport=True, clip=clip)
        return b64decode(taken["data"])

    def close(self) -> None:
        """Close the page, as people do."""
        self._browser.call("Target.closeTarget", targetId=self._target)


@contextmanager
def tabs(url: str, folder: Path) -> Iterator[Callable[..., Tab]]:
    """A browser that opens tabs of a page; called with a width and a height in pixels."""
    with _remote(folder / "profile", 180) as browser:
        yield lambda *size: Tab(browser, url, *size)


@contextmanager
def _remote(profile: Path, seconds: int = 60) -> Iterator[_Browser]:
    """A browser that listens on its third file descriptor and answers on the fourth."""
    assert CHROMIUM is not None
    (their_in, our_out), (our_in, their_out) = os.pipe(), os.pipe()
    options = [*QUIET, f"--user-data-dir={profile}", "--remote-debugging-pipe"]
    # It ends with its pipes; and after a minute or so they end, and with them the test.
    script = f'exec timeout -s KILL {seconds} "$@" 3<&{their_in} 4>&{their_out}'
    command = ["bash", "-c", script, "bash", CHROMIUM, *options]
    browser = subprocess.Popen(command, pass_fds=(their_in, their_out), stderr=subprocess.DEVNULL)
    os.close(their_in)
    os.close(their_out)
    try:
        with os.fdopen(our_out, "wb") as commands, os.fdopen(our_in, "rb") as answers:
            yield _Browser(commands, answers)
    finally:
        browser.wait()
