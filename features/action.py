"""Action feature: 38 numbers of the robot's body when the action is over (paper, section 4.2.1).

| numbers | what | scaled to [0, 1] by |
| --- | --- | --- |
| 3 | hand relative to the attended object, metres, robot frame; z above the table | its training range |
| 1 | rate at which the fingers bend | is in [0, 1] |
| 6, 16, 3 | joints of head, right arm (7 of the arm, 9 of the hand), torso | the joints' limits |
| 9 | touch: 5 fingertips, 4 palm patches | is in [0, 1] |
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data_collection.joints import TACTILE_NAMES

Array = NDArray[np.float64]

log = logging.getLogger(__name__)

HAND = slice(0, 3)
"""The numbers of an action that place the hand relative to the object."""
FINGER_RATE = 3
"""The number of an action that is the rate at which the fingers bend."""
_FAR_OUTSIDE = 0.1


def action_names(joint_names: Sequence[str]) -> tuple[str, ...]:
    """Name the numbers of an action, in order; 38 for the iCub's 25 joints."""
    return ("hand_x", "hand_y", "hand_z", "finger_rate", *joint_names, *TACTILE_NAMES)


@dataclass(frozen=True, eq=False)
class Scale:
    """What maps raw numbers to [0, 1] and back; a range of zero maps to 0.

    Attributes:
        lowest: float64 (dim,), raw value that becomes 0.
        highest: float64 (dim,), raw value that becomes 1.
    """

    lowest: Array
    highest: Array

    def scale(self, raw: Array) -> Array:
        """Scale raw numbers (…, dim), and leave what lies beyond the ranges beyond them."""
        width = self.highest - self.lowest
        return np.where(width > 0, (raw - self.lowest) / np.where(width > 0, width, 1), 0.0)

    def unscale(self, scaled: Array) -> Array:
        """Undo `scale` for numbers (…, dim)."""
        return self.lowest + scaled * (self.highest - self.lowest)


def hand_target(scale: Scale, action: Array, object_position: Array, table_height: float) -> Array:
    """Give where an action puts the hand, metres in the robot frame.

    Args:
        scale: Of actions.
        action: (…, dim_a), scaled, as the model knows it.
        object_position: (…, 2), metres on the table.
        table_height: Height of the table (z), metres.
    """
    relative = scale.unscale(action)[..., HAND]
    height = np.full((*object_position.shape[:-1], 1), table_height)
    return np.asarray(relative + np.concatenate([object_position, height], axis=-1))


def within_limits(scaled: Array, names: Sequence[str], trials: NDArray[np.int64]) -> Array:
    """Put scaled actions (D, dim_a), except the hand's place, back into [0, 1]; warn of what is far outside.

    Encoders and touch are noisy, so a joint at its limit may read as a little beyond it.
    """
    bounded = np.clip(scaled, 0, 1)
    bounded[:, HAND] = scaled[:, HAND]
    for row, column in np.argwhere(np.abs(scaled - bounded) > _FAR_OUTSIDE):
        log.warning(
            "trial %d: %s is at %.2f of its range; taken as %.0f",
            trials[row], names[column], scaled[row, column], bounded[row, column],
        )  # fmt: skip
    return bounded


def fit_action_scale(hands: Array, joint_lower: Array, joint_upper: Array) -> Scale:
    """Scale the hand by its range over the training trials, joints by their limits, the rest by 0 to 1.

    Args:
        hands: (D, 3), hand relative to the attended object in the training trials.
        joint_lower: (J,) lower limits of the joints, radians.
        joint_upper: (J,) upper limits of the joints.
    """
    rest = np.zeros(len(TACTILE_NAMES))
    return Scale(
        np.concatenate([hands.min(axis=0), [0.0], joint_lower, rest]),
        np.concatenate([hands.max(axis=0), [1.0], joint_upper, rest + 1]),
    )
