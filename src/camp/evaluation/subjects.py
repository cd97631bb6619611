"""Who can be judged: run folders and ONNX policies, beside baselines that do not walk."""

from __future__ import annotations

from pathlib import Path

from camp.build import Run, build_actor
from camp.common.seeding import generator
from camp.evaluation.contract import Contract, contract_on
from camp.evaluation.controllers import NetworkController, OpenLoopSine, Standing, robot_of
from camp.evaluation.evaluator import MakeController, Subject
from camp.evaluation.policies import OnnxAnswer, contract_of_run
from camp.evaluation.suite import file_digest
from camp.runs.checkpoint import latest_checkpoint


def subject_of_run(run: Run, folder: Path, name: str, baselines: bool, robot: str | None = None) -> Subject:
    """The deterministic policy of a run folder, on its own robot or on another one."""
    contract = contract_of_run(name, run.config)
    if robot is not None:
        contract = contract_on(contract, robot)
    beside: dict[str, MakeController] = {}
    if baselines:
        untrained = build_actor(run.config, generator(run.config.seed, "weights"))
        beside = {"untrained": lambda: NetworkController(contract, untrained)} | _baselines(contract)
    return Subject(
        name=contract.name,
        contract=contract,
        controller=lambda: NetworkController(contract, run.actor),
        policy=file_digest(latest_checkpoint(folder)),
        variant=run.config.variant,
        iteration=run.iteration,
        seed=run.config.seed,
        baselines=beside,
    )


def subject_of_onnx(answer: OnnxAnswer, contract: Contract, baselines: bool) -> Subject:
    """Anybody's policy. Raises CampError where the network does not fit its contract."""
    answer.check(contract)
    return Subject(
        name=contract.name,
        contract=contract,
        controller=lambda: NetworkController(contract, answer),
        policy=file_digest(answer.path),
        baselines=_baselines(contract) if baselines else {},
    )


def _baselines(contract: Contract) -> dict[str, MakeController]:
    robot = robot_of(contract)
    return {"standing": lambda: Standing(robot), "sine": lambda: OpenLoopSine(robot, contract.skill_set)}
