"""The same instructions on every x86-64 processor: what the libraries of the jobs read from their environment.

Libraries look at the processor and choose among kernels that add in different orders or with fused operations, so
that last digits differ, and what hangs on them: a contact of the hand, a category of k-means. All of them can be told
what to choose. So jobs run with the kernels that each of these processors has (SSE4.2, x86-64-v2), whatever it has
beside them, and one thread each. What is compiled by Numba needs no such pin: it does as the source says.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, MutableMapping

_LIBRARIES = ("OMP", "OPENBLAS", "MKL", "NUMEXPR", "NUMBA")
_HWCAPS = "glibc.cpu.hwcaps"
# Names of glibc from 2.33 on, and those before.
_BEYOND = [f"-{name}{usable}" for name in ("AVX", "AVX2", "AVX512F", "FMA", "FMA4") for usable in ("", "_Usable")]

PINNED = {
    # One thread per job: the same bytes on any number of cores, and as many jobs as cores.
    **{f"{library}_NUM_THREADS": "1" for library in _LIBRARIES},
    # The linear algebra of NumPy, SciPy and OpenCV.
    "OPENBLAS_CORETYPE": "Nehalem",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    # PyTorch: its own kernels, those of oneDNN, and MKL, which has one path that is the same for all vendors.
    "ATEN_CPU_CAPABILITY": "default",
    "ONEDNN_MAX_CPU_ISA": "SSE41",
    "MKL_CBWR": "COMPATIBLE",
    "OPENCV_CPU_DISABLE": "AVX,FP16,AVX2,AVX512-SKX",
    "OPENCV_IPP": "disabled",
    "OPENCV_LOG_LEVEL": "ERROR",  # or it warns of that in every log
    "OPENCV_OPENCL_RUNTIME": "disabled",
    "ARROW_USER_SIMD_LEVEL": "SSE4_2",
}
"""What each variable is in a job; `GLIBC_TUNABLES` comes to these, see `pinned`."""


def pinned(environment: Mapping[str, str]) -> dict[str, str]:
    """What a job's environment has instead of, or beside, what an environment says.

    glibc's mathematical functions are chosen by `GLIBC_TUNABLES`, in which other tunables stay as they are. It is
    read when a process begins.
    """
    others = [one for one in environment.get("GLIBC_TUNABLES", "").split(":") if one and not one.startswith(_HWCAPS)]
    return PINNED | {"GLIBC_TUNABLES": ":".join([*others, f"{_HWCAPS}={','.join(_BEYOND)}"])}


def pin(environment: MutableMapping[str, str] = os.environ) -> None:
    """Let processes that start from here on be pinned."""
    environment.update(pinned(environment))


def begin_pinned() -> None:
    """Begin the program anew with the pins, unless it has them: glibc reads its own when a process begins."""
    whole = {**os.environ, **pinned(os.environ)}
    if whole != dict(os.environ):
        os.execve(sys.executable, sys.orig_argv, whole)
