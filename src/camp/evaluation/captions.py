"""What a film says over its pictures: the skill asked for, velocities, and when the feet stood."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from camp.gaits.gait import GAITS
from camp.gaits.skills import split_name
from camp.robots.quadruped import FOOT_NAMES

CONTACTS_S = 2.0  # s of contacts that are shown; the present is at the right edge
AVERAGED_S = 0.5  # over which the velocity is shown: a stride of 2 Hz
INK, PAPER, OTHER_GAIT = (23, 33, 43), (255, 255, 255, 200), "#5b6875"
ROWS_PER_PICTURE = 24  # heights of a line of text in that of a picture


@dataclass(frozen=True)
class Take:
    """T control steps of one robot, as they are filmed."""

    period_s: float
    skill: list[str]  # T names, as asked for
    command: NDArray[np.floating]  # (3,) vx, vy in m/s, yaw rate in rad/s
    velocity: NDArray[np.floating]  # (T, 3) the same, as measured
    contact: NDArray[np.bool_]  # (T, 4) FL, FR, RL, RR
    qpos: NDArray[np.floating]  # (T, 19)

    def until(self, steps: int) -> Take:
        """Its first ``steps`` control steps."""
        cut = slice(None, steps)
        return Take(self.period_s, self.skill[cut], self.command, self.velocity[cut], self.contact[cut], self.qpos[cut])


def colour(skill: str) -> str:
    """The colour of the skill's gait."""
    gait = GAITS.get(split_name(skill)[0])
    return OTHER_GAIT if gait is None else gait.colour


def caption(picture: NDArray[np.uint8], take: Take, step: int) -> NDArray[np.uint8]:
    """A picture (height, width, 3) of a control step with its caption."""
    image = Image.fromarray(picture)
    line = image.height // ROWS_PER_PICTURE
    draw, font = ImageDraw.Draw(image, "RGBA"), ImageFont.load_default(line * 0.8)
    skill = take.skill[step]
    name = draw.textlength(skill, font=font) + line
    draw.rectangle((0, 0, name, 1.5 * line), fill=colour(skill))
    draw.text((line / 2, 0.75 * line), skill, fill="white", font=font, anchor="lm")
    velocity = _velocity(take, step)
    left = image.width - draw.textlength(velocity, font=font) - line
    draw.rectangle((left, 0, image.width, 1.5 * line), fill=PAPER)
    draw.text((left + line / 2, 0.75 * line), velocity, fill=INK, font=font, anchor="lm")
    _draw_contacts(draw, image.size, take, step)
    return np.asarray(image)


def _velocity(take: Take, step: int) -> str:
    """What was asked for, and the mean of what was measured."""
    first = max(0, step + 1 - round(AVERAGED_S / take.period_s))
    vx, vy, yaw_rate = take.velocity[first : step + 1].mean(axis=0)
    asked = take.command
    parts = [f"{vx:.2f} m/s, {asked[0]:.2f} asked for"]
    if asked[1]:
        parts.append(f"left {vy:.2f}, {asked[1]:.2f}")
    if asked[2]:
        parts.append(f"turn {yaw_rate:.2f}, {asked[2]:.2f} rad/s")
    return "; ".join(parts)


def _draw_contacts(draw: ImageDraw.ImageDraw, size: tuple[int, int], take: Take, step: int) -> None:
    """Stance bars of the last CONTACTS_S, a row for each foot, at the bottom right: the near feet are at the left."""
    width, height = size
    row = max(8, height // ROWS_PER_PICTURE * 2 // 3)
    top, steps = height - len(FOOT_NAMES) * row - row // 2, round(CONTACTS_S / take.period_s)
    edge = width // 2
    left, right = edge + 3 * row, width - row
    font = ImageFont.load_default(row * 0.8)
    draw.rectangle((edge, top - row // 2, width, height), fill=PAPER)
    for leg, foot in enumerate(FOOT_NAMES):
        draw.text((edge + row / 2, top + (leg + 0.45) * row), foot, fill=INK, font=font, anchor="lm")
    for shown, leg, begin, end in stance_bars(take.contact, step, steps, (left, right)):
        y = top + leg * row
        draw.rectangle((begin, y, end, y + row - 3), fill=colour(take.skill[shown]))


def stance_bars(
    contact: NDArray[np.bool_], step: int, steps: int, edges: tuple[int, int]
) -> Iterator[tuple[int, int, int, int]]:
    """Control step, leg, first and last pixel of every stance in the ``steps`` control steps up to ``step``.

    contact: (T, 4); edges: pixels at the left and the right, where the present is.
    """
    left, right = edges
    for before in range(min(steps, step + 1)):
        end, begin = (right - round(n * (right - left) / steps) for n in (before, before + 1))
        for leg in np.flatnonzero(contact[step - before]):
            yield step - before, int(leg), begin, end - 1
