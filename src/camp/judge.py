"""Judge anybody's walking: ``python -m camp.judge <what> [suite=short] [output=<folder>] ...``; see docs/judge.md.

policy=<file.onnx> contract=<file.json>  a policy behind its contract (without one: what camp.export wrote)
run=<run folder>                         a run of camp.train, or a shipped policy
                                         [robot=a1] another robot than it was trained for
contacts=<log.csv or .npz>               four contacts against time, of any robot or simulator
                                         [skill=trot_3hz] [threshold_n=<N>] [discard_s=<s>]
expert                                   the shipped expert's clips [robot=a1]
labelled                                 the judge itself, on motions whose right answer is known
report=<file.json>                       all tables of a report that was written before, such as <run folder>/eval.json

suite=full (the default) is suite v1; output=<folder> holds <name>.json (default: outputs/judge).
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from camp.build import load_run
from camp.cli.key_values import key_values, run_command
from camp.common.errors import CampError, ConfigError
from camp.common.files import make_folder, write_text
from camp.common.progress import track
from camp.deployment.contract import contract_inside
from camp.evaluation.cells import fitted, table_console
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.contact_log import read_log
from camp.evaluation.contact_report import contact_json, contact_tables, judge_log
from camp.evaluation.contract import contract_on, read_contract
from camp.evaluation.evaluator import Evaluator, Subject
from camp.evaluation.expert import judge_expert
from camp.evaluation.labelled import answers_table, labelled_answers
from camp.evaluation.output import expert_motions, motions_beside, print_report
from camp.evaluation.policies import OnnxAnswer
from camp.evaluation.report import read_report, write_report
from camp.evaluation.subjects import subject_of_onnx, subject_of_run
from camp.motion.clips.clip import Clip
from camp.robots.registry import DEFAULT_ROBOT, find_robot

OUTPUT = Path("outputs") / "judge"
KINDS = ("policy", "run", "contacts", "report")


def judge(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises CampError."""
    if "labelled" in arguments:
        key_values([a for a in arguments if a != "labelled"], required=[])
        answers = list(labelled_answers())
        _print(answers_table(answers))
        return
    if "expert" in arguments:
        given = key_values([a for a in arguments if a != "expert"], required=[], optional=["robot", "output"])
        report = judge_expert(find_robot(given.get("robot", DEFAULT_ROBOT), "robot"))
        path = _output(given) / f"{report.run}.json"
        write_report(path, report)
        print_report(report, path)
        print(f"wrote {path}")
        return
    kind = next((kind for kind in KINDS if any(a.startswith(f"{kind}=") for a in arguments)), None)
    if kind is None:
        raise ConfigError(
            "nothing to judge: give policy=, run=, contacts= or report=<file>, expert or labelled; see --help"
        )
    if kind == "report":
        path = Path(key_values(arguments, ["report"])["report"])
        print_report(read_report(path, "judge it again"), path, everything=True)
    elif kind == "contacts":
        _judge_contacts(key_values(arguments, ["contacts"], ["skill", "threshold_n", "discard_s", "output"]))
    else:
        optional = ["robot", "suite", "output", "threads", *(["contract"] if kind == "policy" else [])]
        _judge_policy(kind, key_values(arguments, [kind], optional))


def _judge_policy(kind: str, given: dict[str, str]) -> None:
    overrides = [f"suite={given.get('suite', 'full')}", f"threads={given.get('threads', 0)}"]
    evaluation, output = compose_evaluation(overrides), _output(given)
    subject, clips = _subject(kind, given, evaluation.baselines)
    judgement = Evaluator(evaluation, clips, track).judge(subject)
    path = output / f"{_file_name(subject.name)}.json"
    write_report(path, judgement.report)
    print_report(judgement.report, path)
    print(f"wrote {path}")


def _subject(kind: str, given: dict[str, str], baselines: bool) -> tuple[Subject, list[Clip]]:
    """Who is judged, and the expert's clips beside it."""
    path, robot = Path(given[kind]), given.get("robot")
    if robot is not None:
        find_robot(robot, "robot")
    if kind == "run":
        run = load_run(path)
        subject = subject_of_run(run, path, path.resolve().name, baselines, robot)
        return subject, motions_beside(run) if robot is None else expert_motions(find_robot(robot))
    answer = OnnxAnswer(path)
    contract = read_contract(Path(given["contract"])) if "contract" in given else contract_inside(answer)
    if robot is not None:
        contract = contract_on(contract, robot)
    return subject_of_onnx(answer, contract, baselines), expert_motions(find_robot(contract.robot))


def _judge_contacts(given: dict[str, str]) -> None:
    path = Path(given["contacts"])
    threshold = _number(given, "threshold_n") if "threshold_n" in given else None
    discard = _number(given, "discard_s") if "discard_s" in given else 0.0
    report = judge_log(read_log(path, threshold), path.name, given.get("skill"), discard)
    _print(*contact_tables(report))
    if "output" in given:
        target = _output(given) / f"{_file_name(path.stem)}.json"
        write_text(target, contact_json(report))
        print(f"wrote {target}")


def _number(given: dict[str, str], key: str) -> float:
    try:
        value = float(given[key])
    except ValueError as error:
        raise ConfigError(f"{key} = {given[key]!r}: give a number") from error
    if not 0.0 <= value < math.inf:
        raise ConfigError(f"{key} = {given[key]!r}: give a finite number of 0 or more")
    return value


def _output(given: dict[str, str]) -> Path:
    return make_folder(Path(given.get("output", OUTPUT)))


def _file_name(name: str) -> str:
    """A name without what file systems do not take. Raises CampError where nothing is left."""
    kept = "".join(c if c.isalnum() or c in "_-." else "_" for c in name).strip("._")
    if not kept:
        raise CampError(f"name {name!r}: give the contract a name of letters or digits")
    return kept


def _print(*tables: Table) -> None:
    console = table_console()
    for part in (part for whole in tables for part in fitted(whole, console.width)):
        console.print(part)


if __name__ == "__main__":
    sys.exit(run_command(judge, sys.argv[1:], __doc__))
