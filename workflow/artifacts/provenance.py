"""What made an artifact: hashes of code and of the environment."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MACHINERY = "workflow"
FORMAT = 1
"""Stands in every key for the machinery: all of `workflow/` but the scripts of the rules, which no digest contains.

Raise it with a change of the machinery that changes the bytes of artifacts or of their records: what
`workflow.execution.job` does around a script, or what `parts_of_code` gives to logs. Everything is then made again.
"""


@cache
def code_hash(script: Path, *modules: str) -> str:
    """sha256 over a script and every project module that it imports, directly or not; found once per process.

    The modules are found by reading the import statements, so there is no list to keep. Of each the syntax tree
    counts, without comments, layout and docstrings.

    Args:
        script: the script.
        modules: paths from the root of the project of modules that the script is told to import, and which no
            import statement names.
    """
    return _digest(script, *modules)


def code_is_unchanged(script: Path, *modules: str) -> bool:
    """Whether the code of a script is still what `code_hash` found."""
    try:
        return _digest(script, *modules) == code_hash(script, *modules)
    except (OSError, SyntaxError):
        return False


def _digest(script: Path, *modules: str) -> str:
    digest = hashlib.sha256(f"format {FORMAT}\0".encode())
    for path in sorted(imported_files(script, *(ROOT / module for module in modules))):
        digest.update(f"{path.relative_to(ROOT).as_posix()}\0{_syntax(path.read_bytes())}\0".encode())
    return digest.hexdigest()


@cache
def _syntax(source: bytes) -> str:
    """The sha256 of a module's syntax tree."""
    return hashlib.sha256(ast.dump(_WithoutDocstrings().visit(ast.parse(source))).encode()).hexdigest()


class _WithoutDocstrings(ast.NodeTransformer):
    """Removes strings that are statements, which do nothing."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        return None if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str) else node


@cache
def lock_hash() -> str:
    """sha256 of environment.lock."""
    return hashlib.sha256((ROOT / "environment.lock").read_bytes()).hexdigest()


def rule_code(script: Path, *modules: str) -> str:
    """What a rule's parameter `code` must be: the hash of its script and `modules`, and that of the lock file."""
    return code_hash(script, *modules) + lock_hash()


def parts_of_code(code: str) -> dict[str, str]:
    """The two hashes that `rule_code` put together, by the names that logs have for them."""
    return {"code_sha256": code[:64], "lock_sha256": code[64:]}


def imported_files(*scripts: Path) -> set[Path]:
    """Scripts and all files of the project that they import, directly or not; package markers, but no machinery."""
    found: set[Path] = set()
    waiting = [script.resolve() for script in scripts]
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
    """The project's files that importing a dotted name executes; none where it is not the project's, or machinery."""
    parts = name.split(".")
    if parts[0] == MACHINERY:
        return
    for depth in range(1, len(parts) + 1):
        base = ROOT.joinpath(*parts[:depth])
        for candidate in (base.with_suffix(".py"), base / "__init__.py"):
            if candidate.is_file():
                yield candidate
