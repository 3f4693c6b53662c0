"""The commands on the results of a study, and the page in a browser: a sentence, what is marked, what is done."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil
import pytest
from PIL import Image

from evaluation.__main__ import main
from evaluation.talk.robots import choose, load_robot, robots_of
from evaluation.talk.scenes import SceneName, Scenes
from evaluation.talk.understanding import hear
from tests.browser import Tab, needs_chromium, tabs
from tests.synthetic import WORDS

pytestmark = pytest.mark.slow
SENTENCE = "grasp the front cup"
SHOWN = "document.querySelector('.sight svg, .sight circle') !== null"
DONE = "document.querySelector('.deed').textContent"
WORDS_SHOWN = "[...document.querySelectorAll('.panel .word')].map((one) => one.firstChild.textContent).join(' ')"


@dataclass(frozen=True)
class Served:
    """A server of the page in a process of its own."""

    url: str
    process: subprocess.Popen[str]

    def simulating(self) -> set[int]:
        """The numbers of the processes that it has started to simulate."""
        children = psutil.Process(self.process.pid).children(recursive=True)
        return {child.pid for child in children if "spawn_main" in " ".join(child.cmdline())}


@contextmanager
def _server(results: Path) -> Iterator[Served]:
    """A server of the page, which is interrupted in the end as people do."""
    words = [sys.executable, "-m", "evaluation", "talk", str(results), "--port", "0"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield Served(process.stdout.readline().split()[0], process)
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(30) in (0, -signal.SIGKILL)


@pytest.fixture(scope="module")
def served(finished: Path) -> Iterator[Served]:
    with _server(finished) as one:
        yield one


def typed(tab: Tab, sentence: str) -> None:
    """Replace the sentence, by the keyboard alone, and wait until it is understood."""
    tab.run("document.getElementById('sentence').select()")
    if sentence:
        tab.type(sentence)
    else:
        tab.press("Backspace", 8)


def enter(tab: Tab) -> None:
    tab.press("Enter", 13, "\r")


def test_the_commands_understand_act_and_describe(
    finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["tell", str(finished), SENTENCE, "--draw", "7", "--out", str(tmp_path / "clip.gif")]) == 0
    told = capsys.readouterr().out
    assert "draw 7" in told
    assert "← this one" in told
    seen = told.split("the tutor saw: ")[1].split()[0]
    assert seen in WORDS["action"]
    said = told.split("the robot says: ")[1].splitlines()[0].split()
    assert len(said) == 4
    assert set(said) <= {word for words in WORDS.values() for word in words}
    with Image.open(tmp_path / "clip.gif") as clip:
        assert clip.size == (360, 270)
        clip.seek(5)  # it has more pictures than one
    assert main(["describe", str(finished), "--draw", "7"]) == 0
    assert "the tutor says: " in capsys.readouterr().out


def test_what_is_told_of_an_instruction_is_what_the_study_did(
    finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The choice is not tied, so that the action, its log and the tutor's word are those of the study, too."""
    asked = ["--method", "proposed", "--seed", "1"]
    answers = finished / "generation/simulator/default/proposed/published/D6/ROW0/seed1/answers.csv"
    row = dict(zip(*[line.split(",") for line in answers.read_text().splitlines()[:2]], strict=True))
    clip = str(tmp_path / "clip.gif")
    assert main(["tell", str(finished), row["instruction"], *asked, "--scene", "1", "--out", clip]) == 0
    told = capsys.readouterr().out
    assert f"the tutor saw: {row['judged']}" in told
    assert f"did: something to object {int(row['chosen']) + 1}\n" in told


@needs_chromium
def test_a_sentence_is_typed_understood_and_done(finished: Path, served: Served, tmp_path: Path) -> None:
    robot = load_robot(finished, choose(finished, robots_of(finished), {}))
    scenes = Scenes(finished, robot.data)
    table, row = scenes.features(robot, scenes.scene(robot, SceneName(1)))
    expected = hear(robot, table, row, SENTENCE)
    with tabs(served.url, tmp_path) as opened:
        tab = opened(400, 800)
        tab.until(SHOWN)
        tab.type(SENTENCE)  # the box has the focus
        tab.until(f"{WORDS_SHOWN} === '{SENTENCE}'")
        marked = "[...document.querySelectorAll('.chosen')].map((one) => Number(one.dataset.object))"
        assert tuple(tab.run(marked)) == expected.chosen
        assert tab.run("document.querySelectorAll('.sight svg .box').length") == len(expected.objects)
        assert "Unknown to it: the" in tab.run("document.getElementById('status').textContent")
        assert tab.run("document.documentElement.scrollWidth <= innerWidth")
        enter(tab)
        tab.until("document.querySelector('.clip').dataset.pictures > 0")
        assert not tab.run(DONE), "pictures come before the end"
        told = tab.until(DONE)
        pictures = tab.run("Number(document.querySelector('.clip').dataset.pictures)")
        assert pictures >= 5
        assert told.split("The tutor saw: ")[1].split(".")[0] in WORDS["action"]
        assert SENTENCE in tab.run("document.getElementById('history').textContent")
        assert tab.run("document.querySelector('.clip img').naturalWidth") == 360

        typed(tab, "blorp cup")
        tab.until("document.querySelector('.word.unknown')?.firstChild.textContent === 'blorp'")
        typed(tab, "")
        tab.until("document.getElementById('do').disabled && document.querySelectorAll('.word').length === 0")
        typed(tab, "cup " * 40)
        tab.until("document.getElementById('problem').textContent.includes('a sentence of 40 words (at most 12')")
        assert tab.run("document.getElementById('do').disabled")
        html = "<img src=x onerror=alert(1)> cup"
        typed(tab, html)
        tab.until("document.querySelectorAll('.word').length === 4")
        assert tab.run("document.querySelectorAll('.panel .sentence img').length") == 0
        assert "onerror=alert(1" in tab.run("document.querySelector('.panel .sentence').textContent")


@needs_chromium
def test_two_pages_take_turns_and_a_closed_one_ends_its_job(served: Served, tmp_path: Path) -> None:
    with tabs(served.url, tmp_path) as opened:
        pages = [opened(), opened(), opened()]
        for tab in pages:
            tab.until(SHOWN)
            tab.run("document.getElementById('sentence').focus()")
            tab.type("cup")
            tab.until("!document.getElementById('do').disabled")
        simulating = served.simulating()
        assert len(simulating) == 1
        enter(pages[0])
        pages[0].until("document.querySelector('.clip').dataset.pictures > 0")
        enter(pages[1])
        pages[1].until("document.querySelector('.clip figcaption').textContent === '1 before you …'")
        enter(pages[2])
        pages[0].close()
        pages[1].until(DONE)
        assert served.simulating().isdisjoint(simulating), "its process went on"
        pages[2].until(DONE)


@needs_chromium
def test_without_a_simulation_the_page_understands_and_says_that_it_cannot_act(
    finished: Path, tmp_path: Path
) -> None:
    own = tmp_path / "own"
    shutil.copytree(finished, own, ignore=shutil.ignore_patterns("mcap", "percepts", "transforms.npz"))
    with _server(own) as served, tabs(served.url, tmp_path) as opened:
        tab = opened(400, 800)
        tab.until(SHOWN)
        tab.type("cup")
        tab.until(f"{WORDS_SHOWN} === 'cup' && document.querySelectorAll('.sight circle.chosen').length > 0")
        assert "cannot act" in tab.run(DONE)
        assert tab.run("document.getElementById('do').disabled && document.getElementById('draw').hidden")


@needs_chromium
def test_the_page_says_that_the_server_has_stopped(finished: Path, tmp_path: Path) -> None:
    with _server(finished) as served, tabs(served.url, tmp_path) as opened:
        tab = opened()
        tab.until(SHOWN)
        tab.type("cup")
        tab.until("!document.getElementById('do').disabled")
        enter(tab)
        tab.until("document.querySelector('.clip').dataset.pictures > 0")
        children = psutil.Process(served.process.pid).children(recursive=True)
        served.process.kill()
        tab.until("document.getElementById('problem').textContent.startsWith('The server has stopped')")
        assert tab.run("document.querySelector('.clip figcaption').textContent") == "It broke off"
        assert psutil.wait_procs(children, 20)[1] == [], "what it started goes on without it"
