"""Look at pages with a real browser, where the machine has one."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from html import unescape
from pathlib import Path

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_chromium = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium on this machine (Debian: apt install chromium)"
)

# Nothing that the browser does of its own accord, such as looking for updates.
QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update", "--virtual-time-budget=10000"),
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
        anchors: the ids of its elements.
        lost_links: links within the page that lead nowhere.
        images: how many there are.
        broken_images: the alternative texts of images that were not shown.
        silent_images: how many images have no alternative text.
        fetched: what was asked for over a network, whether it came or not.
        width: pixels by which the page is wider than the window.
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
        page: the page.
        folder: an empty folder for the copy and the browser's profile.
        window: width, height in pixels.
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
    done = subprocess.run(
        [CHROMIUM, *options, page.as_uri()], capture_output=True, text=True, check=True, timeout=120
    )
    return done.stdout


def _told(document: str) -> str:
    found = re.search(r'<pre id="told-by-the-test">(.*?)</pre>', document, re.DOTALL)
    assert found is not None, f"the script did not run: {document[-500:]}"
    return unescape(found[1])
