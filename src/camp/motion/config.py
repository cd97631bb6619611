"""Schema of conf/motion: the clips and the skills."""

from __future__ import annotations

from dataclasses import dataclass

from omegaconf import MISSING

from camp.common import checks
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import FREQUENCY_RANGE_HZ, LABELS, Skill, skill_set


@dataclass
class MotionConfig:
    """conf/motion: the expert clips and the skills they teach."""

    folder: str | None = MISSING  # None: the clips shipped with the package
    skills: list[str] = MISSING  # gaits
    labels: str = MISSING  # gait: a skill is a gait; gait_frequency: a gait at one stride frequency
    frequencies_hz: list[float] = MISSING  # of the clips that are used, within skills.FREQUENCY_TOLERANCE
    mirrored: bool = MISSING  # also the left-right mirror images, perturbed clips' without their start
    num_preloaded: int = MISSING  # transitions
    perturbed_folder: str | None = MISSING  # None: one below <output_dir>/motions
    perturbed_clips: int = MISSING  # for imitation

    def skill_set(self) -> tuple[Skill, ...]:
        """The skills in label order."""
        return skill_set(self.skills, self.labels, self.frequencies_hz)

    def check(self) -> None:
        checks.place("motion.folder", self.folder)
        checks.place("motion.perturbed_folder", self.perturbed_folder)
        skills = list(self.skills)
        unknown = [skill for skill in skills if skill not in GAIT_PHASES]
        remedy = f"choose from {', '.join(GAIT_PHASES)}"
        checks.require(len(skills) > 0, "motion.skills", skills, remedy)
        checks.require(not unknown, "motion.skills", skills, f"unknown gait {', '.join(unknown)}; {remedy}")
        checks.require(len(set(skills)) == len(skills), "motion.skills", skills, "name each gait once")
        checks.require(self.labels in LABELS, "motion.labels", self.labels, f"choose one of {', '.join(LABELS)}")
        frequencies = list(self.frequencies_hz)
        low, high = FREQUENCY_RANGE_HZ
        holds = len(frequencies) > 0 and all(low <= f <= high for f in frequencies)
        remedy = f"list stride frequencies from {low:g} to {high:g} Hz, each once"
        checks.require(
            holds and len(set(frequencies)) == len(frequencies), "motion.frequencies_hz", frequencies, remedy
        )
        checks.count("motion.num_preloaded", self.num_preloaded)
        checks.count("motion.perturbed_clips", self.perturbed_clips)
