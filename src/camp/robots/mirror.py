"""What a mirror in the robot's x-z plane makes of its numbers: left becomes right, and some signs change."""

from __future__ import annotations

from dataclasses import dataclass

from camp.robots.quadruped import FOOT_NAMES, JOINT_KINDS, NUM_LEGS

_OTHER_SIDE = {"L": "R", "R": "L"}
_OTHER_LEG = tuple(FOOT_NAMES.index(name[0] + _OTHER_SIDE[name[1]]) for name in FOOT_NAMES)
_JOINT_SIGN = tuple(-1.0 if kind == "hip" else 1.0 for kind in JOINT_KINDS)  # the hips turn about x


@dataclass(frozen=True)
class Mirror:
    """The image has ``sign[i] * values[order[i]]`` in place i; mirroring twice gives the values back."""

    order: tuple[int, ...]
    sign: tuple[float, ...]

    @classmethod
    def signs(cls, *sign: float) -> Mirror:
        """Every number stays in its place."""
        return cls(tuple(range(len(sign))), sign)


def _per_leg(sign: tuple[float, ...]) -> Mirror:
    """Legs change places, each with as many numbers as there are signs."""
    size = len(sign)
    return Mirror(tuple(leg * size + i for leg in _OTHER_LEG for i in range(size)), sign * NUM_LEGS)


VECTOR = Mirror.signs(1.0, -1.0, 1.0)  # of lengths and velocities: y turns round
ROTATION = Mirror.signs(-1.0, 1.0, -1.0)  # of angular velocities: about x and z turn round
QUATERNION = Mirror.signs(1.0, -1.0, 1.0, -1.0)  # w, x, y, z
TWIST = Mirror.signs(1.0, -1.0, -1.0)  # vx, vy, yaw rate
SCALAR = Mirror.signs(1.0)
JOINTS = _per_leg(_JOINT_SIGN)  # positions, velocities, torques
JOINT_PROPERTIES = _per_leg((1.0,) * len(JOINT_KINDS))  # gains and the like, without a direction
FEET = _per_leg((1.0,))
LINKS = Mirror((0, *(1 + i for i in JOINT_PROPERTIES.order)), (1.0, *JOINT_PROPERTIES.sign))  # the base comes first
