"""Schema of conf/motion: which clips, and the skills that they teach."""

from __future__ import annotations

from dataclasses import dataclass

from omegaconf import MISSING

from camp.common import checks
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import LABELS, Skill, skill_set


@dataclass
class MotionConfig:
    """conf/motion: the expert clips and the skills they teach."""

    folder: str | None = MISSING  # None: the clips shipped with the package
    skills: list[str] = MISSING  # gaits
    labels: str = MISSING  # gait: a skill is a gait; gait_frequency: a gait at one stride frequency
    frequencies_hz: list[float] = MISSING  # stride frequencies of the clips that are used
    mirrored: bool = MISSING  # also the left-right mirror images, perturbed clips' without their start
    num_preloaded: int = MISSING  # transitions
    perturbed_folder: str | None = MISSING  # None: one below <output_dir>/motions
    perturbed_clips: int = MISSING  # for imitation

    def skill_set(self) -> tuple[Skill, ...]:
        """The skills in label order."""
        return skill_set(self.skills, self.labels, self.frequencies_hz)

    def check(self) -> None:
        skills = list(self.skills)
        unknown = [skill for skill in skills if skill not in GAIT_PHASES]
        remedy = f"choose from {', '.join(GAIT_PHASES)}"
        checks.require(len(skills) > 0, "motion.skills", skills, remedy)
        checks.require(not unknown, "motion.skills", skills, f"unknown gait {', '.join(unknown)}; {remedy}")
        checks.require(len(set(skills)) == len(skills), "motion.skills", skills, "name each gait once")
        checks.require(self.labels in LABELS, "motion.labels", self.labels, f"choose one of {', '.join(LABELS)}")
        frequencies = list(self.frequencies_hz)
        holds = len(frequencies) > 0 and all(f > 0 for f in frequencies) and len(set(frequencies)) == len(frequencies)
        checks.require(holds, "motion.frequencies_hz", frequencies, "list stride frequencies above 0, each once")
        checks.count("motion.num_preloaded", self.num_preloaded)
        checks.count("motion.perturbed_clips", self.perturbed_clips)
