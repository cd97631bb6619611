"""Do a file's velocities say what its positions do: at its rate, in its frames?"""

from __future__ import annotations

import numpy as np

from camp.common.errors import ClipError
from camp.motion.exchange.motion import FRAMES, Motion, Velocities, derive_velocities
from camp.motion.exchange.rotations import rotate, rotate_inverse

RATE_ERROR = 0.15  # by which positions may change faster or slower than the velocities say
# Velocities against differences of positions, root mean square as a fraction of the velocities' own (plus a floor).
# Mocap is noisy and every file differentiates in its own way; a wrong frame or column gives 1 or more.
MISMATCH = 0.4
CLEAR_MISMATCH = 0.1  # from which it matters whether another frame fits twice as well
EQUAL = 0.02  # of their size by which velocities may miss plain differences and still be such (rounding)
JOINT_FLOOR, LINEAR_FLOOR, ANGULAR_FLOOR = 0.5, 0.1, 0.3  # rad/s, m/s, rad/s
_DERIVE = "pass --derive-velocities to compute them from the positions"


def check_velocities(motion: Motion) -> None:
    """Compare the file's velocities with its positions; raises ClipError for another rate, scale or frame."""
    if motion.velocities is None:
        return
    derived = derive_velocities(motion)
    given = motion.velocities
    _check_scale(motion.rate_hz, given, derived)
    _check_fit("joint velocities", _mismatch(given.joint, derived.joint, JOINT_FLOOR))
    _check_frames(motion, given, derived)
    _check_fit("root linear velocity", _mismatch(given.base_linear, derived.base_linear, LINEAR_FLOOR))
    _check_fit("root angular velocity", _mismatch(given.base_angular, derived.base_angular, ANGULAR_FLOOR))


def are_differences(motion: Motion) -> bool:
    """Whether the file's velocities are mere differences to the next or the previous frame, half a frame off."""
    if motion.velocities is None:
        return False
    given = motion.velocities.joint
    difference = np.diff(motion.joint_position, axis=0) * motion.rate_hz
    errors = [np.sqrt(np.mean((difference - velocity) ** 2)) for velocity in (given[:-1], given[1:])]
    return bool(min(errors) < EQUAL * np.sqrt(np.mean(given**2)))


def _check_fit(name: str, mismatch: float) -> None:
    if mismatch > MISMATCH:
        raise ClipError(
            f"the {name} misses the change of the positions by {mismatch:.2f} of its size, at most {MISMATCH} is "
            f"allowed; check the columns, or {_DERIVE}"
        )


def _check_frames(motion: Motion, given: Velocities, derived: Velocities) -> None:
    """Each root velocity in the other frame: where one fits twice as well, both frames are named at once."""
    quantities = {
        "linear": (given.base_linear, derived.base_linear, LINEAR_FLOOR),
        "angular": (given.base_angular, derived.base_angular, ANGULAR_FLOOR),
    }
    fitting, reasons = [], []
    for (name, (value, true, floor)), declared in zip(quantities.items(), motion.velocity_frames, strict=True):
        other = FRAMES[1 - FRAMES.index(declared)]
        # `value` has been read as declared, and stands in the base frame.
        turned = (rotate_inverse if other == "world" else rotate)(motion.base_quaternion, value)
        mismatch, found = _mismatch(value, true, floor), _mismatch(turned, true, floor)
        wrong = mismatch > CLEAR_MISMATCH and found < mismatch / 2
        fitting.append(other if wrong else declared)
        if wrong:
            reasons.append(
                f"the root {name} velocity misses the change of the positions by {mismatch:.2f} of its size in the "
                f"{declared} frame, by {found:.2f} in the {other} frame"
            )
    if reasons:
        frames = fitting[0] if fitting[0] == fitting[1] else ",".join(fitting)
        raise ClipError(f"{'; '.join(reasons)}; pass --velocity-frame {frames}")


def _check_scale(rate_hz: float, given: Velocities, derived: Velocities) -> None:
    """Positions that change r times as fast as all velocities say were sampled at another rate.

    Where only the joints or only the root differ, it is these velocities that are wrong and not the rate.
    """
    joint = _scale(given.joint, derived.joint, JOINT_FLOOR)
    # Lengths: the same in every frame.
    root = _scale(_length(given.base_linear), _length(derived.base_linear), LINEAR_FLOOR)
    wrong = {name: ratio for name, ratio in (("joint", joint), ("root", root)) if _is_off(ratio)}
    if not wrong:
        return
    verbs = {"joint": "the joints move", "root": "the root moves"}
    told = " and ".join(f"{verbs[name]} {ratio:.2f} times" for name, ratio in wrong.items())
    message = f"at {rate_hz:g} Hz {told} as fast as the file's {' and '.join(wrong)} velocities say"
    if joint is None or root is None:
        still = "joints hardly move" if joint is None else "root hardly moves"
        remedy = f"the {still} and cannot tell why: pass the true rate with --rate, or, if that is it, {_DERIVE}"
    elif len(wrong) == 2 and min(joint, root) > RATE_ERROR and not _is_off(joint / root):
        # The root is smoother than the joints: its differences are its velocities.
        remedy = f"the motion was sampled at about {rate_hz / root:.3g} Hz: pass --rate {rate_hz / root:.3g}"
    elif len(wrong) == 2:
        remedy = f"check the columns, or {_DERIVE}"
    else:
        fitting = "root" if "joint" in wrong else "joints"
        remedy = f"the {fitting} agree{'s' * (fitting == 'root')} with that rate; if it is right, {_DERIVE}"
    raise ClipError(f"{message}; {remedy}")


def _is_off(ratio: float | None) -> bool:
    return ratio is not None and abs(ratio - 1.0) > RATE_ERROR


def _scale(given: np.ndarray, derived: np.ndarray, floor: float) -> float | None:
    """By which factor the derived velocities (N, D) are the given ones; None where these stand still."""
    given, derived = _smooth(given), _smooth(derived)
    size = float((given**2).sum())
    return None if np.sqrt(size / given.size) < floor else float((given * derived).sum()) / size


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=1, keepdims=True)


def _mismatch(given: np.ndarray, derived: np.ndarray, floor: float) -> float:
    size = np.sqrt(np.mean(given**2)) + floor
    return float(np.sqrt(np.mean((_smooth(given) - _smooth(derived)) ** 2)) / size)


def _smooth(values: np.ndarray) -> np.ndarray:
    """Mean over three frames (N - 2, ...): forward, central and backward differences come close to each other."""
    return (values[:-2] + values[1:-1] + values[2:]) / 3
