"""What the priors of each ablation reward, without reinforcement learning: `python -m analysis.incentive`.

`python -m analysis.incentive [seeds=0,1,2] [iterations=100] [output=ablations/results/incentive.json]` trains the
priors of every arm on the expert's clips (`analysis.expert_priors`), shows them held-out expert motion of skill j under
label k, and writes the mean rewards, K x K for K skills. Where motion of the commanded skill is not worth more than
others, no learner can be taught to obey. `show=<result>` prints the margins of a result, `make figures` draws it.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from analysis import expert_priors
from analysis.arms import ARMS, title_of
from analysis.load import AnalysisError
from analysis.provenance import provenance
from analysis.tables import Table
from camp.algo.prior import Prior
from camp.build import expert_clips
from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.common.files import write_text
from camp.common.threads import set_threads
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.data import Transition
from camp.gaits.skills import names

# Small batches and a large rate: nothing moves but the priors, so that they can be quick.
PRESET = (
    *("run=scratch", "env.foot_stance=false", "motion.labels=gait"),  # as the study `reduced`
    *("sim=cpu", "sim.num_envs=64", "motion.num_preloaded=40000"),
    *(f"algo.{prior}.{value}" for prior in ("style", "skill") for value in ("batch_size=256", "updates=1")),
    *(f"algo.{prior}.learning_rate=1e-3" for prior in ("style", "skill")),
)
RESULT = Path("ablations/results/incentive.json")
ASKED = 500  # transitions of each skill that the priors are asked about


@dataclass(frozen=True)
class Incentive:
    """Mean reward of one seed's priors, (K shown, K commanded), weighted as in eq. (2); zeros without the prior."""

    arm: str
    fakes: str
    seed: int
    style: list[list[float]]
    skill: list[list[float]]


@dataclass(frozen=True)
class Margin:
    """How far the reward tells the commanded skill from others.

    mean: of the diagonal less that of the rest; worst: the least advantage of the commanded skill over the best-paid
    other one, over the commands.
    """

    mean: float
    worst: float


def margin(reward: NDArray[np.floating]) -> Margin:
    """The margins of a matrix (K shown, K commanded)."""
    own = np.diag(reward)
    off = ~np.eye(len(reward), dtype=bool)
    best_other = np.where(off, reward, -np.inf).max(axis=0)
    return Margin(float(own.mean() - reward[off].mean()), float((own - best_other).min()))


def reward_matrix(prior: Prior, asked: Transition, num_skills: int) -> NDArray[np.floating]:
    """Weighted mean reward (K, K) of motion that shows skill j, row, under label k, column."""
    rows = []
    for shown in range(num_skills):
        motion = asked.take(asked.skill == shown)
        motion = motion.take(torch.linspace(0, len(motion) - 1, min(ASKED, len(motion))).long())
        labels = [torch.full_like(motion.skill, label) for label in range(num_skills)]
        rows.append([float(prior.reward(Transition(motion.state, label)).mean()) for label in labels])
    return prior.weight * np.array(rows)


def measure(seeds: Sequence[int], iterations: int) -> Iterator[Incentive]:
    """Every arm, kind of fakes and seed. Arms whose priors are the same share their training."""
    known: dict[tuple, Incentive] = {}
    clips = expert_clips(compose_config(PRESET))
    for seed in seeds:
        first = compose_config([*PRESET, f"seed={seed}"])
        shown = expert_priors.show(first, clips)
        pool = expert_priors.untrained_motion(first, clips)
        for arm in ARMS:
            config = compose_config([*PRESET, f"+ablation={arm}", f"seed={seed}"])
            for kind in expert_priors.FAKES:
                same = (_priors_of(config), kind, seed)
                if same not in known:
                    fakes = expert_priors.make_fakes(kind, shown, pool)
                    known[same] = _measure_one(config, shown, fakes, iterations)
                found = known[same]
                yield Incentive(arm, kind, seed, found.style, found.skill)


def _priors_of(config: Config) -> str:
    style, skill = asdict(config.algo.style), asdict(config.algo.skill)
    skill.pop("patience_s")
    return json.dumps([part if part["enabled"] else None for part in (style, skill)])


def _measure_one(config: Config, shown: expert_priors.Shown, fakes: expert_priors.Fakes, iterations: int) -> Incentive:
    priors, num_skills = expert_priors.fresh_priors(config), len(config.motion.skill_set())
    expert_priors.train(priors, shown, fakes, iterations, config.seed)
    found = {prior.name: reward_matrix(prior, shown.asked, num_skills).tolist() for prior in priors}
    nothing = np.zeros((num_skills, num_skills)).tolist()
    return Incentive("", "", config.seed, found.get("style", nothing), found.get("skill", nothing))


def margins(rows: Sequence[Incentive]) -> dict[tuple[str, str, str], list[float]]:
    """Mean margins by arm, fakes and prior, one for each seed."""
    found: dict[tuple[str, str, str], list[float]] = {}
    for row in rows:
        for prior in ("style", "skill"):
            found.setdefault((row.arm, row.fakes, prior), []).append(margin(np.array(getattr(row, prior))).mean)
    return found


def margin_table(rows: Sequence[Incentive]) -> Table:
    """Means over seeds, by arm and fakes: both priors' margins, and the worst margin of their sum in any seed."""
    found, cells = margins(rows), []
    for arm, fakes in dict.fromkeys((row.arm, row.fakes) for row in rows):
        sums = [np.array(row.style) + np.array(row.skill) for row in rows if (row.arm, row.fakes) == (arm, fakes)]
        figures = [
            *(np.mean(found[arm, fakes, prior]) for prior in ("style", "skill")),
            min(margin(r).worst for r in sums),
        ]
        cells.append([title_of(arm), fakes, *(f"{value + 0.0:.2f}" for value in figures)])
    return Table(["arm", "fakes", "style", "skill", "worst"], cells)


def read_incentives(path: Path = RESULT) -> tuple[list[str], list[Incentive]]:
    """Names of the skills and all rows. Raises AnalysisError where the file is missing or damaged."""
    try:
        plain = json.loads(path.read_text(encoding="utf-8"))
        return list(plain["skills"]), [Incentive(**row) for row in plain["arms"]]
    except OSError as error:
        raise AnalysisError(
            f"result {path}: {error.strerror or error}; make it with `python -m analysis.incentive`"
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise AnalysisError(
            f"result {path}: cannot be read ({error}); make it with `python -m analysis.incentive`"
        ) from error


def run(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises ConfigError."""
    given = key_values(arguments, required=[], optional=["seeds", "iterations", "output", "show"])
    if "show" in given:
        print(margin_table(read_incentives(Path(given["show"]))[1]).as_markdown())
        return
    try:
        seeds = [int(seed) for seed in given.get("seeds", "0,1,2").split(",")]
        iterations = int(given.get("iterations", "100"))
    except ValueError as error:
        raise ConfigError(f"arguments {' '.join(arguments)}: give whole numbers, seeds=0,1,2 iterations=100") from error
    set_threads(1)  # the least time for batches this small
    begun, origin, rows = time.perf_counter(), provenance(), []
    for found in measure(seeds, iterations):
        rows.append(found)
        reward = np.array(found.style) + np.array(found.skill)
        print(f"seed {found.seed} {found.arm} against {found.fakes}: margin {margin(reward).mean:.3f}", flush=True)
    result = {
        "study": "incentive",
        "skills": list(names(compose_config(PRESET).motion.skill_set())),
        "preset": list(PRESET),
        "iterations": iterations,
        "seconds": round(time.perf_counter() - begun, 1),
        **origin,
        "arms": [asdict(row) for row in rows],
    }
    path = Path(given.get("output", RESULT))
    write_text(path, json.dumps(result) + "\n")
    print(f"wrote {path}")


if __name__ == "__main__":
    sys.exit(run_command(run, sys.argv[1:], __doc__))
