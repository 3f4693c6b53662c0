"""Count the bad inputs that were tried: a test marked `bad_input` is one input that must be refused by name."""

from __future__ import annotations

from collections import Counter

import pytest


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many bad inputs of each kind were refused, out of how many tried."""
    tried: Counter[str] = Counter()
    refused: Counter[str] = Counter()
    for outcome in ("passed", "failed"):
        for report in terminalreporter.getreports(outcome):
            if report.when == "call" and "bad_input" in report.keywords:
                file = report.nodeid.split("::")[0]
                tried[file] += 1
                refused[file] += outcome == "passed"
    for file in sorted(tried):
        terminalreporter.write_line(f"bad inputs refused in {file}: {refused[file]} of {tried[file]}")
