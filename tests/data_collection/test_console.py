"""What commands print, wherever it goes, and how they end."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence

import pytest

from data_collection.__main__ import main as data_collection
from data_collection.console import STOPPED, counted, run_command
from data_collection.user_folders import user_cache
from evaluation.__main__ import main as evaluation
from model.__main__ import main as model
from workflow.command_line import main as workflow

COMMANDS = {"data_collection": data_collection, "evaluation": evaluation, "model": model, "workflow": workflow}


@pytest.mark.parametrize(
    ("encoding", "printed"),
    [
        ("ascii", '"grasp" 3 x 2... \\u306f\n'),
        ("latin-1", '"grasp" 3 × 2... \\u306f\n'),
        ("utf-8", "“grasp” 3 × 2… は\n"),
    ],
)
def test_output_that_cannot_show_everything_shows_what_it_can(encoding: str, printed: str) -> None:
    text = "from data_collection.console import print_anywhere; print_anywhere(); print('“grasp” 3 × 2… は')"
    environment = os.environ | {"PYTHONIOENCODING": encoding}
    done = subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, check=True)
    assert done.stdout.decode(encoding) == printed


def test_numbers_with_their_nouns() -> None:
    assert [counted(number, "problem") for number in (0, 1, 2, 3000)] == [
        "no problems",
        "1 problem",
        "2 problems",
        "3,000 problems",
    ]
    assert counted(2, "artifact is", "artifacts are") == "2 artifacts are"


def raising(error: BaseException) -> Callable[[], int]:
    def command() -> int:
        raise error

    return command


def test_an_interrupt_is_one_word(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(raising(KeyboardInterrupt())) == STOPPED
    assert run_command(raising(KeyboardInterrupt()), stopped=1) == 1
    assert capsys.readouterr().err == "stopped\nstopped\n"


def test_nobody_reads_to_the_end() -> None:
    """As `| head` does: no traceback, neither at the line that fails nor when Python ends."""
    text = (
        "import sys\nfrom data_collection.console import run_command\n"
        "def many():\n    for _ in range(100_000):\n        print('line')\n    return 0\nsys.exit(run_command(many))"
    )
    line = [sys.executable, "-c", text]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 0


def parsers(main: Callable[[Sequence[str]], int]) -> Iterator[argparse.ArgumentParser]:
    """The parsers of a package's commands."""
    found: list[argparse.ArgumentParser] = []

    def keep(parser: argparse.ArgumentParser, _: object) -> None:
        found.append(parser)
        raise SystemExit

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(argparse.ArgumentParser, "parse_args", keep)
        with pytest.raises(SystemExit):
            main([])
    for action in found[0]._actions:
        if isinstance(action, argparse._SubParsersAction):
            yield from action.choices.values()


@pytest.mark.parametrize("package", COMMANDS)
def test_help_says_what_holds_where_nothing_is_said(package: str) -> None:
    commands = list(parsers(COMMANDS[package]))
    assert commands
    for parser in commands:
        for action in parser._actions:
            assert action.help, f"{parser.prog}: {action.dest}"
            if action.option_strings and not action.required and action.dest != "help":
                assert "(default: " in action.help, f"{parser.prog}: {action.dest}"
        parser.format_help()


def test_the_users_cache_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/xdg")
    assert str(user_cache()) == "/xdg/cross-situational-learning"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")  # does not count
    monkeypatch.setenv("HOME", "/home/me")
    assert str(user_cache()) == "/home/me/.cache/cross-situational-learning"
    monkeypatch.setattr("data_collection.user_folders.Path.home", raising(RuntimeError()))
    assert user_cache() is None
