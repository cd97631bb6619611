"""What the numbers of the configuration may be: declared with their types, checked in one walk.

A schema writes ``kp: list[Stiffness]`` with ``Stiffness = Annotated[float, Within(0.01, 1e4, "N m/rad; ...")]``.
OmegaConf and whoever reads the field see a plain float.
"""

from __future__ import annotations

from dataclasses import dataclass, is_dataclass
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from camp.common.errors import ConfigError


@dataclass(frozen=True)
class Within:
    """The lowest and the highest useful value, both finite, and why."""

    low: float
    high: float
    reason: str


Fraction = Annotated[float, Within(0.0, 1.0, "it is a fraction")]
Seconds = Annotated[float, Within(0.001, 86400.0, "s; a millisecond to a day")]
SecondsOrZero = Annotated[float, Within(0.0, 86400.0, "s; up to a day")]
Scale = Annotated[float, Within(0.01, 10.0, "times nominal; beyond a tenfold it is another robot")]
Speed = Annotated[float, Within(-10.0, 10.0, "m/s; no robot of this kind is faster")]
Spin = Annotated[float, Within(-20.0, 20.0, "rad/s; three turns per second")]
Kick = Annotated[float, Within(0.0, 10.0, "m/s; faster than any robot of this kind")]
Friction = Annotated[float, Within(0.001, 10.0, "from wet ice to more than rubber on rubber")]
Weight = Annotated[float, Within(0.0, 1e6, "a weight beside others of order 1")]
Threads = Annotated[int, Within(0, 1024, "more than any machine has processors cannot be started")]
Seed = Annotated[int, Within(0, 2**64 - 1, "torch takes no more than 64 bits")]


def check_numbers(key: str, config: Any) -> None:
    """Raise ConfigError for the first number, anywhere below ``config``, that is none or out of its bounds.

    key: of ``config`` itself, such as ``env``; empty for the root. None passes where the type lets it.
    """
    for name, hint in get_type_hints(type(config), include_extras=True).items():
        value, path = getattr(config, name), f"{key}.{name}" if key else name
        if is_dataclass(value):
            check_numbers(path, value)
        elif (within := _declared(hint)) is not None and not (value is None and type(None) in get_args(hint)):
            listed, whole = get_origin(hint) is list, _number_type(hint) is int
            if not all(_fits(one, within, whole) for one in (value if listed and isinstance(value, list) else [value])):
                wanted = f"list {'whole ' * whole}numbers" if listed else f"choose a {'whole ' * whole}number"
                raise ConfigError(f"{path} = {value!r}: {wanted} {_span(within)}")


def check_number(key: str, value: Any, within: Within) -> None:
    """The same for a number that stands in no dataclass."""
    if not _fits(value, within, whole=False):
        raise ConfigError(f"{key} = {value!r}: choose a number {_span(within)}")


def bounds_of(hint: Any) -> Within:
    """What a type such as ``list[Fraction]`` or ``Seconds | None`` declares. Raises KeyError where it does not."""
    found = _declared(hint)
    if found is None:
        raise KeyError(f"{hint}: a type without Within")
    return found


def _declared(hint: Any) -> Within | None:
    if get_origin(hint) is Annotated:
        return next((one for one in hint.__metadata__ if isinstance(one, Within)), None)
    return next((found for part in get_args(hint) if (found := _declared(part)) is not None), None)


def _span(within: Within) -> str:
    """``from 0 to 1 (it is a fraction)``."""
    low, high = (str(end) if isinstance(end, int) else f"{end:g}" for end in (within.low, within.high))
    return f"from {low} to {high} ({within.reason})"


def _fits(value: Any, within: Within, whole: bool) -> bool:
    # By type: True is an int, too. No comparison with NaN holds.
    return type(value) in ((int,) if whole else (int, float)) and within.low <= value <= within.high


def _number_type(hint: Any) -> type | None:
    if hint in (int, float):
        return hint
    return next((found for part in get_args(hint) if (found := _number_type(part)) is not None), None)
