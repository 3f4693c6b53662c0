"""Hashes of the code and of the environment that make an artifact."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MACHINERY = "workflow"
FORMAT = 2
"""Represents the machinery in every key: all of `workflow/` except the rules' scripts, which no digest includes.

Raise it when a change to the machinery alters the bytes of artifacts or records, for instance what
`workflow.execution.job` does around a script, or what `parts_of_code` writes to logs. Everything is then made again.
"""


@cache
def code_hash(script: Path, *modules: str) -> str:
    """sha256 of a script and every project module that it imports, directly or not; computed once per process.

    Modules are found by reading the import statements. Their syntax trees are hashed, without docstrings, and so are
    other files in their folders, such as templates.

    Args:
        script: The script.
        modules: Further modules, which a script imports by a name that it is given, as paths from the project's root.
    """
    return _digest(script, *modules)


def code_is_unchanged(script: Path, *modules: str) -> bool:
    """Whether the code of a script still has the hash that `code_hash` returned."""
    try:
        return _digest(script, *modules) == code_hash(script, *modules)
    except (OSError, SyntaxError):
        return False


def _digest(script: Path, *modules: str) -> str:
    digest = hashlib.sha256(f"format {FORMAT}\0".encode())
    files = imported_files(script, *(ROOT / module for module in modules))
    data = {each for folder in {path.parent for path in files} for each in folder.iterdir() if each.is_file()}
    for path in sorted(files | {each for each in data if each.suffix not in (".py", ".pyc")}):
        is_module = path.suffix == ".py"
        content = _parsed(path.read_bytes())[0] if is_module else hashlib.sha256(path.read_bytes()).hexdigest()
        digest.update(f"{path.relative_to(ROOT).as_posix()}\0{content}\0".encode())
    return digest.hexdigest()


@cache
def _parsed(source: bytes) -> tuple[str, frozenset[str]]:
    """The sha256 of a module's syntax tree, and the names that it imports."""
    tree = ast.parse(source)
    names = frozenset(imported_names(tree))
    return hashlib.sha256(ast.dump(_WithoutDocstrings().visit(tree)).encode()).hexdigest(), names


class _WithoutDocstrings(ast.NodeTransformer):
    """Removes statements that are only a string."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        return None if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str) else node


@cache
def lock_hash() -> str:
    """sha256 of environment.lock."""
    return hashlib.sha256((ROOT / "environment.lock").read_bytes()).hexdigest()


def rule_code(script: Path, *modules: str) -> str:
    """The parameter `code` of a rule: the hash of its script and `modules`, then that of the lock file."""
    return code_hash(script, *modules) + lock_hash()


def parts_of_code(code: str) -> dict[str, str]:
    """The two hashes in the parameter `code`, under their names in logs."""
    return {"code_sha256": code[:64], "lock_sha256": code[64:]}


def imported_files(*scripts: Path) -> set[Path]:
    """Scripts and the project files that they import, directly or not: with package markers, without machinery."""
    found: set[Path] = set()
    waiting = [script.resolve() for script in scripts]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += [file for name in _parsed(path.read_bytes())[1] for file in _files(name)]
    return found


def imported_names(tree: ast.AST) -> Iterator[str]:
    """The dotted names in all import statements; not all of them are modules."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module
            # `from package import module` names a module by its last part.
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def _files(name: str) -> list[Path]:
    """The project files that importing a name executes; none for other packages and the machinery."""
    parts = name.split(".")
    bases = [] if parts[0] == MACHINERY else [ROOT.joinpath(*parts[: i + 1]) for i in range(len(parts))]
    files = [file for base in bases for file in (base.with_suffix(".py"), base / "__init__.py")]
    return [file for file in files if file.is_file()]
