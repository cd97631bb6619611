"""Places are written on every command line as they are, and what a message prints can be pasted back."""

from __future__ import annotations

import shlex

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Transformer

from camp.cli.key_values import key_values
from camp.cli.places import quoted_place
from camp.common.commands import command

ODD = [
    "my runs/a",
    "a (1)",
    "a[b]",
    "a{b}",
    "a:b",
    "a=b",
    'a"b',
    "a'b",
    "é/ü",
    "a;b",
    "a&b|c",
    "$a",
    "a#b",
    "~/runs",
    "a,b",
]


@pytest.mark.parametrize("place", [*ODD, "outputs/latest", "/tmp/x_1-2.3"])
def test_hydra_reads_a_place_as_it_was_written(place):
    (override,) = OverridesParser.create().parse_overrides([quoted_place(f"run={place}", sweep=False)])
    assert override.value() == place


@pytest.mark.parametrize("place", ODD)
def test_a_printed_command_can_be_pasted_back(place):
    words = shlex.split(command("camp.evaluate", run=place))
    assert words[:3] == ["python", "-m", "camp.evaluate"]
    (override,) = OverridesParser.create().parse_overrides([quoted_place(words[3], sweep=False)])
    assert (override.key_or_group, override.value()) == ("run", place)
    assert key_values(words[3:], required=["run"]) == {"run": place}  # camp.export, camp.ship


def test_other_overrides_and_quoted_places_are_left_alone():
    for override in ("motion.skills=[trot,bound]", "+ablation=no_skill_disc", 'run="a b"', "run='a b'", "resume="):
        assert quoted_place(override, sweep=False) == override


def test_a_sweep_over_places_stays_one():
    (override,) = OverridesParser.create().parse_overrides([quoted_place("output_dir=a b,c", sweep=True)])
    assert override.is_sweep_override()
    assert list(override.sweep_iterator(transformer=Transformer.encode)) == ['"a b"', '"c"']
