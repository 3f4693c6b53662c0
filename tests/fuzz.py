"""Random damage of files, for the tests of all readers."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import timedelta

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

Mutation = tuple[str, int, bytes]

MUTATIONS = st.lists(
    st.tuples(
        st.sampled_from(["flip", "overwrite", "insert", "delete", "cut", "repeat"]),
        st.integers(0, 2**32 - 1),
        st.one_of(st.binary(min_size=1, max_size=16), st.sampled_from([b"\xff" * 8, bytes(8), b"\xff\xff\xff\x7f"])),
    ),
    min_size=1,
    max_size=4,
)
"""Up to four damages: what, where (of the length), and with which bytes."""


def mutated(content: bytes, mutations: Sequence[Mutation]) -> bytes:
    """Content after damages."""
    changed = bytearray(content)
    for kind, place, data in mutations:
        at = place % (len(changed) + 1)
        if kind == "flip" and at < len(changed):
            changed[at] ^= 1 << (data[0] % 8)
        elif kind == "overwrite":
            changed[at : at + len(data)] = data
        elif kind == "insert":
            changed[at:at] = data
        elif kind == "delete":
            del changed[at : at + len(data)]
        elif kind == "cut":
            del changed[at:]
        elif kind == "repeat":
            changed[at:at] = changed[at : at + 64]
    return bytes(changed)


def examples(count: int) -> settings:
    """The same `count` examples in every run, each of which may take ten seconds and no more."""
    return settings(
        max_examples=count,
        derandomize=True,
        database=None,
        deadline=timedelta(seconds=10),
        suppress_health_check=list(HealthCheck),
    )


FEW, MANY = 60, 3000
"""Examples of each fuzz test in the fast and in the slow suite."""
