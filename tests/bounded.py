"""Readers run in a process of their own that may take only so much memory."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

_PROGRAM = """
import json, resource, sys
from pathlib import Path
{imports}

paths = json.loads(sys.stdin.read())
warm = Path(paths.pop("warm up")) if "warm up" in paths else None
if warm:
    path = warm
    {statement}
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + {bytes}, used + {bytes}))
found = {{}}
for name, path in paths.items():
    path = Path(path)
    try:
        {statement}
        found[name] = "accepted"
    except {error} as error:
        found[name] = str(error)
    except BaseException as error:
        found[name] = f"NOT REFUSED BY NAME: {{type(error).__name__}}: {{error}}"
print(json.dumps(found))
"""


def errors_within(size: int, imports: str, statement: str, error: str, paths: Mapping[str, Path]) -> dict[str, str]:
    """What a statement on each `path` raises, where the process may take `size` bytes more than its imports.

    Args:
        size: Bytes of address space.
        imports: Import statements.
        statement: One line that reads `path`.
        error: The documented type of error.
        paths: Files by name; one called "warm up" is read first, without a limit and a result.

    Returns:
        The text of the error by name; "accepted" where there was none.

    """
    program = _PROGRAM.format(imports=imports, statement=statement, error=error, bytes=size)
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=json.dumps({name: str(path) for name, path in paths.items()}),
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    found: dict[str, str] = json.loads(done.stdout)
    return found
