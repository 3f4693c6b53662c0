"""The hot kernels against what one core can do: floating-point peak, memory bandwidth, and the roofline they make."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from model.compiled import compiled
from model.data import Floats
from model.distributions.gaussian_densities import gaussian_log_density
from model.distributions.gaussians import GaussianInverseWishart, draw_posterior_gaussians, gaussian_posterior
from model.distributions.predictive import student_log_density
from model.distributions.triangular import update
from model.prior import Prior


@dataclass(frozen=True)
class Kernel:
    """A kernel at one size.

    Attributes:
        kernel: Its name.
        dimension: Of the features.
        flops: Floating-point operations per call, of the algorithm, not of the machine code.
        bytes: Data that a call has to read and write at least once.
        seconds: Processor time of a call, the fastest of many.
    """

    kernel: str
    dimension: int
    flops: float
    bytes: float
    seconds: float


@dataclass(frozen=True)
class Machine:
    """What one core reaches.

    Attributes:
        peak: Floating-point operations per second, of a matrix product of the linear algebra library.
        bandwidth: Bytes per second, of a sum of two arrays too large for the caches.
    """

    peak: float
    bandwidth: float


def fastest(call: Callable[[], object], seconds: float = 0.3) -> float:
    """Processor seconds of the fastest call of those that fit into a time, at least three."""
    call()
    best, until, calls = np.inf, time.thread_time() + seconds, 0
    while time.thread_time() < until or calls < 3:
        before = time.thread_time()
        call()
        best, calls = min(best, time.thread_time() - before), calls + 1
    return float(best)


def measure_machine() -> Machine:
    """Peak and bandwidth of one core; the caller limits the linear algebra library to one thread."""
    square = np.random.default_rng(0).random((512, 512))
    long = np.random.default_rng(0).random(8_000_000)
    target = np.empty_like(long)
    product = fastest(lambda: np.matmul(square, square))
    addition = fastest(lambda: np.add(long, long, out=target))
    return Machine(2.0 * 512**3 / product, 2.0 * long.nbytes / addition)


def measure_kernels(quick: bool) -> Iterator[Kernel]:
    """Each hot kernel at the dimensions of the channels and above."""
    for dim in (10, 30) if quick else (2, 10, 30, 38, 65, 200):
        yield from _kernels_of(dim)


def _kernels_of(dim: int, N: int = 80, K: int = 10) -> Iterator[Kernel]:
    """The hot kernels for N elements of one dimension and K categories."""
    rng = np.random.default_rng(dim)
    x, z, own = rng.random((N, dim)), rng.integers(K, size=N), Prior()
    prior = own.gaussian(dim, own.mean_precisions[0])
    posterior = gaussian_posterior(x, z, K, prior)
    mean, factor = draw_posterior_gaussians(rng, x, z, K, 1, prior)
    triangle = dim * (dim + 1) / 2.0
    solve, scatter, cube = 2.0 * N * K * triangle, 2.0 * N * triangle, K * dim**3 / 3.0
    memory = 8.0 * (N * dim + K * triangle)
    calls: tuple[tuple[str, float, float, Callable[[], object]], ...] = (
        ("gaussian_log_density", solve, memory, lambda: gaussian_log_density(x, mean, factor)),
        ("gaussian_posterior", scatter + cube, memory, lambda: gaussian_posterior(x, z, K, prior)),
        (
            "draw_posterior_gaussians",
            scatter + 2.0 * cube,
            memory + 8.0 * K * triangle,
            lambda: draw_posterior_gaussians(rng, x, z, K, 1, prior),
        ),
        ("student_log_density", solve, memory, lambda: _all_predictive(posterior, x)),
        ("update", 3.0 * solve, memory, lambda: _all_updates(posterior, x)),
    )
    for name, flops, data, call in calls:
        yield Kernel(name, dim, flops, data, fastest(call))


@compiled
def _all_predictive(posterior: GaussianInverseWishart, points: Floats) -> float:
    """The predictive density of every point under every category, as the collapsed sampler asks for them."""
    total, offset = 0.0, np.empty(points.shape[1])
    for point in points:
        for k in range(len(posterior.mean)):
            total += student_log_density(posterior, k, 0.0, point, offset)
    return total


@compiled
def _all_updates(posterior: GaussianInverseWishart, points: Floats) -> float:
    """A rank-one update of every category by every point."""
    total, vector, upper = 0.0, np.empty(points.shape[1]), np.empty(posterior.upper.shape[1:])
    for k in range(len(posterior.mean)):
        upper[:] = posterior.upper[k]
        for point in points:
            vector[:] = point
            update(upper, vector)
        total += upper[0, 0]
    return total
