"""Two ranks with half of the data each learn what one process learns from all of it."""

from __future__ import annotations

from typing import Any

import pytest
import torch
from torch import Tensor, nn

from camp.algo.normalizer import RunningNormalizer
from camp.build import share_of_rank
from camp.common import distributed
from camp.common.averages import Averages
from camp.common.errors import ConfigError
from camp.common.seeding import generator
from tests.algo import halves
from tests.algo.synthetic import assert_identical
from tests.ranks import in_ranks

# Sums of float32 gradients in another order; the largest difference of a weight was 1.2e-7 when this was written.
TOLERANCE = 1e-6


def assert_close(left: Any, right: Any, where: str = "state") -> None:
    """Nested states and metrics are the same but for rounding."""
    if isinstance(left, Tensor):
        torch.testing.assert_close(left, right, rtol=TOLERANCE, atol=TOLERANCE, msg=lambda text: f"{where}: {text}")
    elif isinstance(left, dict):
        assert left.keys() == right.keys(), where
        for key in left:
            assert_close(left[key], right[key], f"{where}.{key}")
    elif isinstance(left, (list, tuple)):
        for index, (a, b) in enumerate(zip(left, right, strict=True)):
            assert_close(a, b, f"{where}[{index}]")
    elif left != right:
        assert left == pytest.approx(right, rel=1e-5, abs=TOLERANCE), where


@pytest.fixture(scope="module")
def trained(tmp_path_factory) -> list[Any]:
    """What both ranks reached."""
    return in_ranks(halves.both, tmp_path_factory.mktemp("ranks"))


def test_ranks_end_with_identical_weights_statistics_rates_and_metrics(trained):
    first, second = trained
    assert_identical(first, second)


@pytest.mark.parametrize("part", ["ppo", "priors"])
def test_two_halves_teach_what_the_whole_teaches(part, trained):
    alone = halves.both()[part]
    assert_close(trained[0][part]["state"], alone["state"])
    assert_close(trained[0][part]["metrics"], alone["metrics"], "metrics")


def test_the_comparison_has_something_to_compare(trained):
    """The adaptive rate moves, and the halves differ: alone, either would have learned something else."""
    rates = {metrics["ppo/learning_rate"] for metrics in trained[0]["ppo"]["metrics"]}
    assert len(rates) > 1
    normalizer = trained[0]["ppo"]["state"]["actor"]["normalizer.count"]
    assert normalizer == halves.UPDATES * 4 * halves.ENVS


def talk() -> dict[str, Any]:
    """Every way of moving data between ranks."""
    rank = distributed.rank()
    layer = nn.Linear(2, 1)
    nn.init.constant_(layer.weight, float(rank + 1))
    layer.register_buffer("statistics", torch.tensor([rank], dtype=torch.float64))
    distributed.copy_from_first([layer])
    rows = RunningNormalizer(2)
    rows.update(torch.tensor([[1.0, 10.0], [3.0, 30.0]]) if rank else torch.zeros(0, 2))
    averages = Averages()
    averages.add("seen", torch.arange(3.0) if rank else torch.tensor([9.0]))
    averages.add_per_skill("right", torch.tensor([1.0]), torch.tensor([rank]), ("trot", "pace"))
    return {
        "total": distributed.total(torch.tensor([1.0, rank])),
        "anywhere": (distributed.anywhere(rank == 1), distributed.anywhere(False)),
        "weight": layer.weight.detach(),
        "statistics": layer.statistics,
        "normalizer": rows.state_dict(),
        "averages": averages.result(),
        "on_first": distributed.on_first(lambda: (distributed.size(), rank)),
        "gather": distributed.gather({"rank": torch.tensor(rank)}),
        "stream": distributed.stream("policy"),
        "draw": torch.rand(1, generator=generator(0, distributed.stream("policy"))).item(),
        "size": distributed.size(),
    }


def test_data_between_ranks(tmp_path):
    first, second = in_ranks(talk, tmp_path)
    for one in (first, second):
        assert one["total"].tolist() == [2.0, 1.0]
        assert one["anywhere"] == (True, False)
        assert one["weight"].tolist() == [[1.0, 1.0]] and one["statistics"].item() == 0.0
        assert one["normalizer"]["mean"].tolist() == [2.0, 20.0] and one["normalizer"]["count"] == 2
        assert one["normalizer"]["variance"].tolist() == [1.0, 100.0]
        assert one["averages"] == {"seen": 3.0, "right/trot": 1.0, "right/pace": 1.0}
        assert one["on_first"] == (1, 0), "alone on the first rank"
        assert one["size"] == 2
    assert first["gather"] == [{"rank": torch.tensor(0)}, {"rank": torch.tensor(1)}] and second["gather"] == []
    assert first["stream"] == "policy" and first["draw"] != second["draw"]


def test_a_world_of_one_needs_no_others():
    value = torch.tensor([3.0])
    assert distributed.total(value) is value and distributed.size() == 1 and distributed.is_first()
    assert distributed.on_first(lambda: 7) == 7 and distributed.gather("state") == ["state"]
    assert distributed.label() == "" and distributed.stream("policy") == "policy"


def test_ranks_share_what_is_configured_for_all(config, monkeypatch):
    config.algo.style.replay_size = 100
    monkeypatch.setattr(distributed, "size", lambda: 2)
    own = share_of_rank(config)
    assert (own.sim.num_envs, own.algo.style.batch_size, own.algo.skill.batch_size) == (4, 64, 64)
    assert own.algo.style.replay_size == 50
    assert own.algo.ppo == config.algo.ppo and config.sim.num_envs == 8
    monkeypatch.setattr(distributed, "size", lambda: 3)
    with pytest.raises(
        ConfigError, match=r"sim.num_envs = 8: the 3 processes share it equally; choose a multiple of 3"
    ):
        share_of_rank(config)
