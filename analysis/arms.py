"""The arms of the ablation study: how the figures and tables name them, and what the paper says of them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Arm:
    """One arm. paper: Table IV's Yes and No for several gaits and for switching on command; None where it has none."""

    title: str
    paper: tuple[bool, bool] | None = None


ARMS: dict[str, Arm] = {
    "full": Arm("full", (True, True)),
    "no_skill_obs": Arm("no skill observation", (True, False)),
    "no_conditioning": Arm("style not conditional", (False, False)),
    "no_skill_disc": Arm("no skill discriminator", (True, False)),
    "neither_conditional": Arm("neither prior conditional"),
    "amp_baseline": Arm("AMP baseline", (False, False)),
    "task_only": Arm("task reward alone"),
    "with_mismatch": Arm("full, with mismatch"),
}


def title_of(arm: str) -> str:
    """An arm's name in figures; of others their own."""
    return ARMS[arm].title if arm in ARMS else arm.replace("_", " ")
