"""Were the targets met?"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from camp.evaluation.config import TargetsConfig


@dataclass(frozen=True)
class Finding:
    """One target beside what was reached."""

    name: str
    target: float
    reached: float | None  # None: there was nothing to measure
    at_least: bool  # the target is a lower bound; else an upper one
    note: str = ""

    @property
    def met(self) -> bool:
        if self.reached is None:
            return False
        return self.reached >= self.target if self.at_least else self.reached <= self.target

    def plain(self) -> dict[str, Any]:
        return asdict(self) | {"met": self.met}


def judge_targets(report: dict[str, Any], targets: TargetsConfig) -> list[Finding]:
    """The targets whose part has been evaluated.

    report: with "policies" and "switching" as in eval.json, where they have been evaluated. Joint tracking is that of
    the switching sequences, as in the paper, or else of the grid.
    """
    trained, switching = report.get("policies", {}).get("trained"), report.get("switching")
    findings = []
    if trained is not None:
        accuracy = {name: part["gait_accuracy"] for name, part in trained["skills"].items()}
        weakest = min(accuracy, key=lambda name: accuracy[name])
        findings.append(Finding("gait accuracy", targets.gait_accuracy, accuracy[weakest], True, f"weakest: {weakest}"))
    if switching is not None and switching["established"] is not None:  # one gait alone has nothing to switch to
        share, note = switching["established"], f"within {switching['within_s']:g} s"
        findings.append(Finding("switches established", targets.switches_established, share, True, note))
    findings += _falls(trained, switching, targets.falls_per_100_episodes)
    if trained is not None:
        for name, key in (
            ("velocity error, m/s", "linear_error_m_s"),
            ("yaw rate error, rad/s", "yaw_rate_error_rad_s"),
        ):
            findings.append(Finding(name, getattr(targets, key), trained["all"][key], False, "mean over the grid"))
    source = switching or (trained or {}).get("all")
    if source is not None:
        where = "switching sequences" if switching else "grid"
        for kind in ("thigh", "calf"):
            reached = source["joint_tracking"].get(kind)
            findings.append(Finding(f"joint tracking, {kind}", targets.joint_tracking, reached, True, where))
    return findings


def _falls(trained: dict[str, Any] | None, switching: dict[str, Any] | None, target: float) -> list[Finding]:
    """Falls among the roll-outs without disturbance, where there were any."""
    counts = [(trained["all"]["falls"], trained["all"]["rollouts"])] if trained else []
    counts += [(switching["falls"], switching["sequences"])] if switching else []
    falls, episodes = sum(count[0] for count in counts), sum(count[1] for count in counts)
    if not episodes:
        return []
    return [Finding("falls per 100 episodes", target, 100.0 * falls / episodes, False, f"{falls} in {episodes}")]
