"""Commands in messages: none is built by hand, and each can be pasted into a shell."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser

from camp.cli.hydra_main import _overrides_first, number_of_jobs
from camp.cli.key_values import key_values
from camp.common.commands import command, torchrun
from camp.dataset import _parser as dataset_parser

ROOT = Path(__file__).parents[2]
SOURCES = [*sorted((ROOT / "src").rglob("*.py")), *sorted((ROOT / "analysis").glob("*.py"))]
PLACES = [
    "outputs/latest",
    "my runs/a (1)",
    "über/läufe",
    "it's here",
    'a "quoted" one',
    "$HOME/run",
    "a=b/c",
    "with, comma",
    "back\\slash",
    "[brackets]{braces}",
    "*?!#;&|<>~",
]


def pasted(text: str) -> list[str]:
    """The arguments that a shell hands to Python."""
    words = shlex.split(text)
    assert words[:2] == ["python", "-m"]
    return words[3:]


@pytest.mark.parametrize("place", PLACES)
def test_one_way_to_write_a_place_for_every_command(place):
    """Hydra's commands, the small ones and argparse's read the same word as the same path."""
    for module, key in (("camp.train", "resume"), ("camp.evaluate", "run")):
        (override,) = _overrides_first(pasted(command(module, **{key: place})))
        assert OverridesParser.create().parse_override(override).value() == place
    for module in ("camp.export", "camp.ship", "camp.judge", "analysis"):
        assert key_values(pasted(command(module, run=place)), ["run"]) == {"run": place}
    options = dataset_parser().parse_args(pasted(command("camp.dataset", "validate", place)))
    assert options.folder == Path(place)
    options = dataset_parser().parse_args(pasted(command("camp.dataset", "perturbed", "--folder", place)))
    assert options.folder == Path(place)
    assert shlex.split(torchrun(2, "camp.train", resume=place))[-1] == f"resume={place}"


def test_no_command_is_built_by_hand():
    by_hand = re.compile(r"(python -m|torchrun) [^`'\"{]*\{")
    found = [
        f"{path.name}: {line.strip()}"
        for path in SOURCES
        for line in path.read_text().splitlines()
        if by_hand.search(line) and not line.lstrip().startswith('"""')
    ]
    assert found == []


def test_a_sweep_knows_how_many_jobs_it_has():
    assert number_of_jobs(["seed=0,1,2", "run=smoke", "sim.num_envs=range(1,3)", "-m"]) == 6
    assert number_of_jobs(["seed=0"]) == 1
    assert number_of_jobs(["seed=", "motion.skills=[trot,bound]", "-m"]) == 1
