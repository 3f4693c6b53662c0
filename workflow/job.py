"""What every job does around its one call: its output goes to its log, warnings and failures also to the screen."""

from __future__ import annotations

import logging
import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def job(snakemake: Any) -> Iterator[None]:
    """Send all that a job prints, also from compiled code, to its log file.

    Warnings and the message of a failure appear on the screen as well, the failure's traceback in the log only.

    Args:
        snakemake: what Snakemake gives a script: inputs, outputs, params, wildcards and log.

    Raises:
        SystemExit: the job failed; the reason has been shown.
    """
    log = snakemake.log[0]
    sys.stdout.flush()
    sys.stderr.flush()
    screen = os.fdopen(os.dup(2), "w")
    with Path(log).open("w") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        to_screen = logging.StreamHandler(screen)
        to_screen.setLevel(logging.WARNING)
        to_screen.setFormatter(logging.Formatter("%(levelname)s %(message)s"))
        to_log = logging.StreamHandler(sys.stderr)
        logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s", handlers=[to_log])
        logging.getLogger().addHandler(to_screen)
        logging.captureWarnings(capture=True)
        try:
            yield
        except Exception as error:
            traceback.print_exc()
            print(f"{type(error).__name__}: {error}\n(more in {log})", file=screen, flush=True)
            raise SystemExit(1) from None
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
