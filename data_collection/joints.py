"""The robot's joints and touch sensors, in the order of logs and features."""

HEAD_JOINTS = ("neck_pitch", "neck_roll", "neck_yaw", "eyes_tilt", "eyes_version", "eyes_vergence")
ARM_JOINTS = (
    "r_shoulder_pitch",
    "r_shoulder_roll",
    "r_shoulder_yaw",
    "r_elbow",
    "r_wrist_prosup",
    "r_wrist_pitch",
    "r_wrist_yaw",
)
HAND_JOINTS = (
    "r_hand_finger",
    "r_thumb_oppose",
    "r_thumb_proximal",
    "r_thumb_distal",
    "r_index_proximal",
    "r_index_distal",
    "r_middle_proximal",
    "r_middle_distal",
    "r_pinky",
)
TORSO_JOINTS = ("torso_pitch", "torso_roll", "torso_yaw")
JOINT_NAMES = HEAD_JOINTS + ARM_JOINTS + HAND_JOINTS + TORSO_JOINTS
"""The 25 joints in the order of logs and features: head 6, right arm 7, right hand 9, torso 3."""

TACTILE_NAMES = (
    "thumb_tip",
    "index_tip",
    "middle_tip",
    "ring_tip",
    "little_tip",
    "palm_index_front",
    "palm_little_front",
    "palm_index_back",
    "palm_little_back",
)
"""The 9 touch sensors: five fingertips, four patches of the palm (side of index or little finger, front or back)."""
