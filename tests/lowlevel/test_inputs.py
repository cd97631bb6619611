"""Keys, the wireless remote and scripts become orders."""

from __future__ import annotations

import os
import struct
from dataclasses import replace

import pytest

from camp.common.errors import CampError
from camp.lowlevel.keyboard import Keyboard, order_of_key
from camp.lowlevel.messages import Reading
from camp.lowlevel.operator import Order, Wanted
from camp.lowlevel.remote import Remote, RemoteInput
from camp.lowlevel.script import EXAMPLE, Script, read_script
from camp.lowlevel.state_machine import Wish
from tests.lowlevel.rig import reading

SKILLS = ["trot_2hz", "pace_2hz", "bound_3hz"]
METADATA = {
    "skills": SKILLS,
    "command_range": {"vx_m_s": [-0.4, 0.9], "vy_m_s": [-0.25, 0.25], "yaw_rate_rad_s": [-0.6, 0.6]},
}


def wanted() -> Wanted:
    return Wanted.of(METADATA, None)


def held(*pressed: str, **sticks: float) -> Reading:
    return replace(reading(), remote=Remote(frozenset(pressed), **sticks).pack())


def test_orders_hold_and_stay_within_the_policys_range():
    holds = wanted()
    holds.take(Order(skill="pace_2hz", velocity=(5.0, -5.0, 0.1)))
    holds.take(Order(wish=Wish.WALK))
    assert (holds.skill, holds.velocity) == ("pace_2hz", (0.9, -0.25, 0.1))
    assert holds.neighbour(1) == "bound_3hz" and holds.neighbour(2) == "trot_2hz"


def test_a_policy_without_a_range_stands_still():
    holds = Wanted.of({"skills": SKILLS}, "bound_3hz")
    holds.take(Order(velocity=(0.5, 0.0, 0.0)))
    assert (holds.skill, holds.velocity) == ("bound_3hz", (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("key", "order"),
    [
        ("u", Order(wish=Wish.STAND)),
        ("g", Order(wish=Wish.WALK)),
        ("l", Order(wish=Wish.LIE)),
        (" ", Order(wish=Wish.STOP)),
        ("q", Order(wish=Wish.LIE, quit=True)),
        ("w", Order(velocity=(0.1, 0.0, 0.0))),
        ("d", Order(velocity=(0.0, 0.0, -0.1))),
        ("x", Order(velocity=(0.0, 0.0, 0.0))),
        ("2", Order(skill="pace_2hz")),
        ("9", Order()),
        ("=", Order()),
        ("ü", Order()),
    ],
)
def test_keys(key, order):
    assert order_of_key(key, wanted()) == order


def test_twelve_skills_have_keys():
    twelve = [f"{gait}_{hz}hz" for gait in ("trot", "pace", "bound", "pronk") for hz in (2, 3, 4)]
    asked = [order_of_key(key, Wanted.of(METADATA | {"skills": twelve}, None)).skill for key in "1234567890-="]
    assert asked == twelve


def test_a_terminal_that_is_gone_lays_the_robot_down():
    read, write = os.pipe()
    keyboard = Keyboard(read)
    os.write(write, b"?g")
    assert keyboard.poll(0.0, None, wanted()) == Order(wish=Wish.WALK)
    assert keyboard.poll(0.0, None, wanted()) == Order()
    os.close(write)
    assert keyboard.poll(0.0, None, wanted()) == Order(wish=Wish.LIE, quit=True)
    assert keyboard.poll(0.0, None, wanted()) == Order(wish=Wish.LIE, quit=True)
    os.close(read)


def test_the_remotes_bytes_are_where_unitree_has_them():
    data = bytearray(40)
    data[2:4] = struct.pack("<H", 1 << 2 | 1 << 9)  # start, B
    for place, value in ((4, 0.25), (8, -0.5), (12, 0.75), (20, 1.0)):
        data[place : place + 4] = struct.pack("<f", value)
    remote = Remote.unpack(bytes(data))
    assert remote == Remote(frozenset({"start", "B"}), lx=0.25, rx=-0.5, ry=0.75, ly=1.0)
    assert remote.pack() == bytes(data)


def test_a_stick_that_is_no_number_is_let_go():
    data = bytearray(40)
    data[20:24] = struct.pack("<f", float("nan"))
    assert Remote.unpack(bytes(data)) == Remote()


def test_buttons_act_once_and_sticks_all_the_time():
    source = RemoteInput()
    assert source.poll(0.0, None, wanted()) == Order()
    pushed = held("start", ly=1.0, lx=1.0, rx=-0.5)
    first, second = source.poll(0.0, pushed, wanted()), source.poll(0.0, pushed, wanted())
    assert first.wish is Wish.STAND and second.wish is None
    assert first.velocity == second.velocity == pytest.approx((0.9, -0.25, 0.3))
    assert source.poll(0.0, held("right"), wanted()) == Order(skill="pace_2hz", velocity=(0.0, 0.0, 0.0))
    assert source.poll(0.0, held("left"), wanted()).skill == "bound_3hz"
    assert source.poll(0.0, held("A", ly=0.05), wanted()) == Order(Wish.WALK, velocity=(0.0, 0.0, 0.0))
    assert source.poll(0.0, held("B"), wanted()).wish is Wish.LIE
    assert source.poll(0.0, held("select"), wanted()).quit


def test_unitrees_own_combination_stops():
    assert Remote(frozenset({"L2", "B"})).stops and not Remote(frozenset({"B"})).stops


def test_a_script_gives_each_entry_at_its_time():
    script = Script(read_script("0.04 walk, 0 stand, 0.04 velocity .5 0 -.1, 0.06 quit", SKILLS))
    found = [script.poll(7.0 + step * 0.02, None, wanted()) for step in range(6)]
    assert [order.wish for order in found] == [Wish.STAND, None, Wish.WALK, None, Wish.LIE, None]
    assert found[3].velocity == (0.5, 0.0, -0.1) and found[4].quit
    assert len(read_script(EXAMPLE, SKILLS)) == 5


@pytest.mark.parametrize(
    "entry", ["walk", "0 fly", "0 skill gallop", "0 velocity 1 2", "0 velocity 1 2 nan", "", "inf stand", "0"]
)
def test_a_wrong_entry_is_named(entry):
    with pytest.raises(CampError, match="--script") as caught:
        read_script(f"0 stand, {entry}", SKILLS)
    assert repr(entry) in str(caught.value)
