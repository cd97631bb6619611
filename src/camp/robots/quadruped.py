"""What all robots of this project share: four legs of three joints each, and their order.

Every array of the project that speaks of legs or joints is in the order of ``FOOT_NAMES`` and ``JOINT_NAMES``. A
robot's model names its joints, bodies, geoms and sensors after them (docs/extending.md).
"""

from __future__ import annotations

FOOT_NAMES = ("FL", "FR", "RL", "RR")
JOINT_KINDS = ("hip", "thigh", "calf")
JOINT_NAMES = tuple(f"{leg}_{kind}_joint" for leg in FOOT_NAMES for kind in JOINT_KINDS)
NUM_LEGS = len(FOOT_NAMES)
NUM_JOINTS = len(JOINT_NAMES)

GRAVITY = 9.81  # m/s^2, of every model
CONTACT_FORCE = 1.0  # N, least ground reaction that counts as contact
