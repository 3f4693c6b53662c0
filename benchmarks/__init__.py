"""Benchmarks of the samplers: time, memory, scaling, and what their hot kernels make of the machine."""

from __future__ import annotations

import os

# Before NumPy is imported: one thread, as for every fit.
for _library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ[f"{_library}_NUM_THREADS"] = "1"
