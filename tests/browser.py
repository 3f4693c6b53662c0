"""Look at pages with a real browser, where the machine has one."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
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


@contextmanager
def _remote(profile: Path) -> Iterator[_Browser]:
    """A browser that listens on its third file descriptor and answers on the fourth."""
    assert CHROMIUM is not None
    (their_in, our_out), (our_in, their_out) = os.pipe(), os.pipe()
    options = [*QUIET, f"--user-data-dir={profile}", "--remote-debugging-pipe"]
    # It ends with its pipes; and after a minute they end, and with them the test.
    command = ["bash", "-c", f'exec timeout -s KILL 60 "$@" 3<&{their_in} 4>&{their_out}', "bash", CHROMIUM, *options]
    browser = subprocess.Popen(command, pass_fds=(their_in, their_out), stderr=subprocess.DEVNULL)
    os.close(their_in)
    os.close(their_out)
    try:
        with os.fdopen(our_out, "wb") as commands, os.fdopen(our_in, "rb") as answers:
            yield _Browser(commands, answers)
    finally:
        browser.wait()
