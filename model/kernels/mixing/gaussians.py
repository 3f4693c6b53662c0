"""Gaussian categories while elements come and go: densities, and changes of their triangular factors."""

from __future__ import annotations

import math

from model.compiled import inlined, lean
from model.data import Floats
from model.distributions.triangular import downdate, solve, update
from model.kernels.mixing.setup import Setup, Tables

# A share of a point in its category, or of a pivot, below which a removal would cancel too many digits.
_SMALLEST_SHARE = 1e-7


@inlined
def log_factor(setup: Setup, tables: Tables, c: int, k: int, i: int, y: Floats) -> float:
    """Log s, by which |C_S| grows if element i joins category k, to which it does not belong; y is working space."""
    upper, n = tables.upper[c, k], tables.n[c, k]
    if setup.by_points[c]:
        products, members = setup.products[c, i], tables.members[c, k]
        for a in range(n):
            y[a] = products[members[a]]
        # C − I is positive semi-definite, so that s ≥ 1 but for rounding.
        return math.log(max(1.0, products[i] - solve(upper, y, 0, n)))
    dim, point, mean = setup.dim[c], setup.features[c, i], tables.mean[c, k]
    for j in range(dim):
        y[j] = point[j] - mean[j]
    return math.log(1.0 + 1.0 / (setup.kappa[c] + n) + solve(upper, y, 0, dim))


@inlined
def log_predictive(setup: Setup, tables: Tables, c: int, k: int, log_s: float) -> float:
    """Log p(x | category k) of an element by whose factor |C_S| would grow."""
    n = tables.n[c, k]
    gained = setup.density[c, n + 1] - setup.density[c, n]
    return float(gained - 0.5 * (setup.nu[c] + n + 1) * log_s - 0.5 * tables.log_det[c, k])


@inlined
def log_density(setup: Setup, tables: Tables, c: int, k: int, i: int) -> float:
    """Log p(x_i | the elements of category k without i itself); kept until the category is another set."""
    identity = tables.identity[c, k]
    if tables.z[c, i] == k:
        if tables.left_out_of[c, i] != identity:
            log_s, n = _log_factor_of_member(setup, tables, c, k, i), tables.n[c, k]
            gained = setup.density[c, n] - setup.density[c, n - 1]
            rest = tables.log_det[c, k] - log_s
            tables.left_out[c, i] = gained - 0.5 * (setup.nu[c] + n) * log_s - 0.5 * rest
            tables.left_out_of[c, i] = identity
        return float(tables.left_out[c, i])
    if tables.predicted_for[c, k, i] != identity:
        log_s = log_factor(setup, tables, c, k, i, tables.work[0])
        tables.predicted[c, k, i] = log_predictive(setup, tables, c, k, log_s)
        tables.predicted_for[c, k, i] = identity
    return float(tables.predicted[c, k, i])


@lean
def _log_factor_of_member(setup: Setup, tables: Tables, c: int, k: int, i: int) -> float:
    """Log s, by which |C_S| would shrink without element i of category k."""
    upper, n, y = tables.upper[c, k], tables.n[c, k], tables.work[0]
    if n == 1:
        return float(tables.log_det[c, k])
    if setup.by_points[c]:
        first = tables.place[c, i]
        y[first] = 1.0
        for a in range(first + 1, n):
            y[a] = 0.0
        return -math.log(min(1.0, solve(upper, y, first, n)))
    dim, point, mean = setup.dim[c], setup.features[c, i], tables.mean[c, k]
    for j in range(dim):
        y[j] = point[j] - mean[j]
    share = 1.0 - 1.0 / (setup.kappa[c] + n) - solve(upper, y, 0, dim)
    if share > _SMALLEST_SHARE:
        return -math.log(share)
    scratch = len(tables.n[c]) - 1
    clear_points(setup, tables, c, scratch)
    for a in range(n):
        if tables.members[c, k, a] != i:
            push(setup, tables, c, scratch, tables.members[c, k, a])
    return float(tables.log_det[c, k] - tables.log_det[c, scratch])


@lean
def clear_points(setup: Setup, tables: Tables, c: int, k: int) -> None:
    """Take all elements out of category k, without a look at z, and without their words."""
    tables.n[c, k], tables.log_det[c, k], tables.identity[c, k] = 0, 0.0, 0
    if not setup.by_points[c]:
        for j in range(setup.dim[c]):
            tables.mean[c, k, j] = 0.0
            for m in range(setup.dim[c]):
                tables.upper[c, k, j, m] = 0.0
            tables.upper[c, k, j, j] = 1.0


@inlined
def push(setup: Setup, tables: Tables, c: int, k: int, i: int) -> None:
    """Append element i to category k, without a look at z."""
    y = tables.work[1]
    append(setup, tables, c, k, i, log_factor(setup, tables, c, k, i, y), y)


@inlined
def append(setup: Setup, tables: Tables, c: int, k: int, i: int, log_s: float, y: Floats) -> None:
    """As `push`, with what `log_factor` returned and left in y."""
    n, upper = tables.n[c, k], tables.upper[c, k]
    if setup.by_points[c]:
        for a in range(n):
            upper[a, n] = y[a]
        upper[n, n] = math.exp(0.5 * log_s)
    else:
        before = setup.kappa[c] + n
        after, mean, point, dim = before + 1.0, tables.mean[c, k], setup.features[c, i], setup.dim[c]
        for j in range(dim):
            deviation = point[j] - mean[j]
            mean[j] += deviation / after
            y[j] = (before / after) ** 0.5 * deviation
        update(upper, y[:dim])
    tables.members[c, k, n] = i
    tables.n[c, k] = n + 1
    tables.log_det[c, k] += log_s
    tables.identity[c, k] ^= setup.key[c, i]


@lean
def attach(setup: Setup, tables: Tables, c: int, k: int, i: int) -> None:
    """Put element i, which is in no category, into category k."""
    tables.place[c, i], tables.z[c, i] = tables.n[c, k], k
    push(setup, tables, c, k, i)


@lean
def detach(setup: Setup, tables: Tables, c: int, i: int) -> None:
    """Take element i out of its category."""
    k = tables.z[c, i]
    log_s = _log_factor_of_member(setup, tables, c, k, i)
    members, upper, at, last = tables.members[c, k], tables.upper[c, k], tables.place[c, i], tables.n[c, k] - 1
    for a in range(at, last):
        members[a] = members[a + 1]
        tables.place[c, members[a]] = a
    tables.z[c, i] = -1
    if last == 0:
        clear_points(setup, tables, c, k)
        return
    tables.n[c, k] = last
    tables.log_det[c, k] -= log_s
    tables.identity[c, k] ^= setup.key[c, i]
    if setup.by_points[c]:
        _drop_column(upper, at, last)
        return
    before, after = setup.kappa[c] + last + 1.0, setup.kappa[c] + last
    y, mean, point, dim = tables.work[1], tables.mean[c, k], setup.features[c, i], setup.dim[c]
    for j in range(dim):
        mean[j] = (before * mean[j] - point[j]) / after
        y[j] = (after / before) ** 0.5 * (point[j] - mean[j])
    if not downdate(upper, y[:dim], _SMALLEST_SHARE):
        _refill(setup, tables, c, k)


@lean
def _refill(setup: Setup, tables: Tables, c: int, k: int) -> None:
    """Compute the factor of V_n of category k anew from its members."""
    n = tables.n[c, k]
    clear_points(setup, tables, c, k)
    for a in range(n):
        push(setup, tables, c, k, tables.members[c, k, a])


@lean
def _drop_column(upper: Floats, at: int, last: int) -> None:
    """Change U (last + 1 square) to the factor without point `at`: its column goes, rotations mend the rows below."""
    for a in range(at):
        row = upper[a]
        for b in range(at, last):
            row[b] = row[b + 1]
    for a in range(at, last):
        row, below = upper[a], upper[a + 1]
        # Row a lacks its first number now, which stands in the row below.
        x, y = row[a + 1], below[a + 1]
        length = (x * x + y * y) ** 0.5
        cosine, sine = x / length, y / length
        row[a] = length
        for b in range(a + 1, last):
            upper_b, below_b = row[b + 1], below[b + 1]
            row[b] = cosine * upper_b + sine * below_b
            below[b + 1] = cosine * below_b - sine * upper_b
