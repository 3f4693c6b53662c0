"""Joints by name: whatever order they come in, whatever others come with them, from one publisher or several."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from data_collection.joints import JOINT_NAMES
from data_collection.log.messages import JointState

_KNOWN = frozenset(JOINT_NAMES)
_NO_VELOCITY = np.zeros(0)


def matched(state: JointState) -> JointState:
    """Return a joint state in the order of `JOINT_NAMES`, without joints that are not among them.

    Velocities that are not as many as the names count as not known: nothing uses them. What cannot be matched comes
    back as it is, and is refused by the checks: a joint is missing, twice there, or without a position.
    """
    places = {name: i for i, name in enumerate(state.names)}
    if len(places) != len(state.names) or len(state.position) != len(state.names) or not set(places) >= _KNOWN:
        return state
    velocity = state.velocity if len(state.velocity) == len(state.names) else _NO_VELOCITY
    order = [places[name] for name in JOINT_NAMES]
    return JointState(JOINT_NAMES, state.position[order], velocity[order] if len(velocity) else velocity)


def merged(states: Sequence[JointState]) -> list[JointState | None]:
    """Return for each joint state the one that it completes, which holds all of `JOINT_NAMES`; None for none.

    Several publishers may each know some of the joints. A state is whole when every joint was heard of since the last
    whole one, so the slowest publisher sets the rate; the last state completes one in any case, since it is the end
    of the action. States of one publisher who knows all joints are whole one by one. Where a joint is never heard
    of, all states come back as they are, and are refused by the checks.

    Args:
        states: In order of time, each `matched`.
    """
    heard = {name for state in states for name in state.names}
    partial = [state for state in states if state.names != JOINT_NAMES]
    if not partial or not heard >= _KNOWN or not all(map(_is_sound, partial)):
        return list(states)
    known: dict[str, tuple[float, float]] = {}
    fresh: set[str] = set()
    found: list[JointState | None] = []
    for i, state in enumerate(states):
        velocity = state.velocity if len(state.velocity) == len(state.names) else np.full(len(state.names), np.nan)
        said = zip(state.names, state.position.tolist(), velocity.tolist(), strict=True)
        mine = {name: (position, speed) for name, position, speed in said if name in _KNOWN}
        known |= mine
        fresh |= set(mine)
        is_whole = len(fresh) == len(JOINT_NAMES) or (i + 1 == len(states) and bool(fresh))
        found.append(_whole(known) if is_whole else None)
        fresh = set() if is_whole else fresh
    return found


def _is_sound(state: JointState) -> bool:
    return len(set(state.names)) == len(state.names) == len(state.position)


def _whole(known: dict[str, tuple[float, float]]) -> JointState:
    position, velocity = np.array([known[name] for name in JOINT_NAMES]).T
    return JointState(JOINT_NAMES, position, velocity if np.isfinite(velocity).all() else _NO_VELOCITY)
