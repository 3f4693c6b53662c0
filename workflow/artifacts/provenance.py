"""What made an artifact: hashes of code and of the environment."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@cache
def code_hash(script: Path) -> str:
    """sha256 over a script and every project module that it imports, directly or not; found once a process.

    The files are found by reading the import statements, so that no list has to be kept.
    """
    return _digest(script)


def code_is_unchanged(script: Path) -> bool:
    """Whether the files of a script are still what `code_hash` found."""
    try:
        return _digest(script) == code_hash(script)
    except OSError:
        return False


def _digest(script: Path) -> str:
    digest = hashlib.sha256()
    for path in sorted(imported_files(script)):
        digest.update(f"{path.relative_to(ROOT).as_posix()}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


@cache
def lock_hash() -> str:
    """sha256 of environment.lock."""
    return hashlib.sha256((ROOT / "environment.lock").read_bytes()).hexdigest()


def rule_code(script: Path) -> str:
    """What a rule's parameter `code` must be: the hash of its script, and that of the lock file."""
    return code_hash(script) + lock_hash()


def parts_of_code(code: str) -> dict[str, str]:
    """The two hashes that `rule_code` put together, by the names that logs have for them."""
    return {"code_sha256": code[:64], "lock_sha256": code[64:]}


def imported_files(script: Path) -> set[Path]:
    """The script and all files of the project that it imports, directly or not, package markers included."""
    found: set[Path] = set()
    waiting = [script.resolve()]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(_imports(path))
    return found


@cache
def _imports(path: Path) -> tuple[Path, ...]:
    return tuple(file for name in imported_names(ast.parse(path.read_bytes(), str(path))) for file in _files(name))


def imported_names(tree: ast.AST) -> Iterator[str]:
    """The dotted names that import statements mention, wherever they stand; not each is a module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module
            # `from package import module` names a module by its last part.
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _files(name: str) -> Iterator[Path]:
    """The project's files that importing a dotted name executes; none where it is not the project's."""
    parts = name.split(".")
    for depth in range(1, len(parts) + 1):
        base = ROOT.joinpath(*parts[:depth])
        for candidate in (base.with_suffix(".py"), base / "__init__.py"):
            if candidate.is_file():
                yield candidate
