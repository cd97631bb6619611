"""Messages are lost, late or cut off as asked."""

from __future__ import annotations

import pytest

from camp.common.errors import CampError
from camp.lowlevel.conditions import Channel, Conditions


def passed(conditions: Conditions, count: int = 1000) -> list[int | None]:
    """What comes out at each of ``count`` steps of 10 ms that send their number."""
    channel, found = Channel(conditions, seed=0), []
    for step in range(count):
        channel.put(step / 100, step)
        found.append(channel.get(step / 100))
    return found


def test_nothing_happens_by_default():
    assert passed(Conditions()) == list(range(1000))


def test_a_delay_moves_every_message():
    assert passed(Conditions(delay_s=0.03), 6) == [None, None, None, 0, 1, 2]


def test_loss_is_the_share_that_is_asked_for():
    lost = sum(value is None for value in passed(Conditions(loss=0.2)))
    assert lost == pytest.approx(200, abs=4 * 13)  # four standard deviations
    assert passed(Conditions(loss=1.0), 3) == [None] * 3


def test_an_outage_begins_and_ends():
    assert passed(Conditions(outage_at_s=0.02, outage_s=0.02), 6) == [0, 1, None, None, 4, 5]


def test_the_newest_of_several_arrivals_counts():
    channel = Channel(Conditions(), seed=0)
    channel.put(0.0, "old")
    channel.put(0.0, "new")
    assert channel.get(0.0) == "new" and channel.get(0.0) is None


@pytest.mark.parametrize("wrong", [{"loss": 1.5}, {"delay_s": -0.1}, {"outage_s": -1.0}])
def test_what_cannot_be_is_refused(wrong):
    with pytest.raises(CampError, match="give"):
        Conditions(**wrong)
