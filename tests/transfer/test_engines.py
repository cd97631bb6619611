"""Every engine holds the same robot: it stands, moves its joints by name, falls, and walks the shipped trot."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from importlib.util import find_spec

import numpy as np
import pytest

from camp.common.errors import CampError, ConfigError
from camp.common.paths import policies_root
from camp.deployment.export import export_policy
from camp.deployment.loop import Policy
from camp.robots.quadruped import JOINT_NAMES
from camp.transfer.description import Description
from camp.transfer.engine import ENGINES, READING_S, contacts_of, engine_version, find_engine, start_engine
from camp.transfer.results import judge
from camp.transfer.walks import EngineBody, Feet, walk
from tests.transfer.descriptions import A1, GO2, description, metadata

MODULES = {"mujoco": "mujoco", "sapien": "sapien", "dart": "dartpy", "drake": "pydrake"}
OTHERS = [name for name in ENGINES if name != "mujoco"]
# rad, by which joints may leave MuJoCo's in free fall; without any rotor the least is .018. DART's rotors are links'.
NEARNESS = {"mujoco": 1e-9, "sapien": 0.012, "dart": 0.035, "drake": 0.012}
STEP = 0.2 * np.array([1, -1, 1, -1, 1, 1, 1, 1, -1, -1, -1, -1])  # rad, of another pattern in each leg


@pytest.fixture(params=ENGINES)
def name(request) -> str:
    return installed(request.param)


@pytest.fixture(params=OTHERS)
def other(request) -> str:
    return installed(request.param)


def installed(name: str) -> str:
    if find_spec(MODULES[name]) is None:
        pytest.skip(f"{MODULES[name]} is not installed; it comes with the sim2sim extra")
    return name


def in_the_air(engine: str, one: Description) -> np.ndarray:
    """Joint positions (20, 12) every 5 ms, from 2 m above the ground, after a step of all targets."""
    started = start_engine(engine, replace(one, height=2.0))
    started.set_targets(one.default_pose + STEP)
    rows = []
    for _ in range(20):
        started.step()
        rows.append(started.state().joint_position)
    assert not started.contacts().feet.any() and not started.contacts().fallen
    return np.array(rows)


@cache
def in_mujoco() -> np.ndarray:
    return in_the_air("mujoco", description())


def test_the_robot_stands_on_four_feet(name):
    engine = start_engine(name, description())
    state = engine.state()
    np.testing.assert_allclose(state.position, [0.0, 0.0, description().height], atol=1e-6)
    np.testing.assert_allclose(state.rotation, np.eye(3), atol=1e-6)
    np.testing.assert_allclose(state.joint_position, description().default_pose, atol=1e-6)
    for _ in range(100):
        engine.step()
    state, contacts = engine.state(), engine.contacts()
    assert contacts.feet.all() and not contacts.fallen
    assert 0.24 < state.position[2] < 0.29 and state.rotation[2, 2] > 0.99
    assert READING_S % engine.timestep_s == pytest.approx(0.0, abs=1e-9) or engine.timestep_s == READING_S


def test_another_robot_stands_as_high_as_its_legs_and_moves_as_in_mujoco(name):
    """The A1, with the Go2's gains."""
    one = description(A1)
    np.testing.assert_allclose(in_the_air(name, one), in_the_air("mujoco", one), rtol=0, atol=NEARNESS[name])
    engine = start_engine(name, one)
    for _ in range(100):
        engine.step()
    state, contacts = engine.state(), engine.contacts()
    assert contacts.feet.all() and not contacts.fallen
    assert one.height == pytest.approx(0.26864, abs=1e-5) and 0.22 < state.position[2] < one.height


def test_joints_follow_their_targets_as_in_mujoco(name):
    """Order, gains, torque limits, rotors, damping and dry friction, link inertias: nothing touches the ground."""
    found = in_the_air(name, description())
    assert (np.sign(found[11] - description().default_pose) == np.sign(STEP)).all()
    np.testing.assert_allclose(found, in_mujoco(), rtol=0, atol=NEARNESS[name])


def test_rotors_are_felt(other):
    """Without their inertia a joint is away from its place sooner."""
    without = in_the_air(other, replace(description(), armature=np.zeros(12)))
    moved = np.abs(without[3] - description().default_pose), np.abs(in_mujoco()[3] - description().default_pose)
    assert moved[0].mean() > 1.15 * moved[1].mean()


def test_motors_stop_at_their_torque_limit(other):
    """Motors of 1 mN m carry nobody: trunk or thighs are on the ground within a second."""
    engine = start_engine(other, replace(description(), torque_limit=np.full(12, 1e-3)))
    for _ in range(200):
        engine.step()
        if engine.contacts().fallen:
            return
    pytest.fail("still upright")


def test_a_reset_is_a_fresh_start(name):
    engine = start_engine(name, description())

    def moved() -> np.ndarray:
        engine.reset()
        engine.set_targets(description().default_pose + 0.5 * STEP)
        for _ in range(40):
            engine.step()
        return np.concatenate([engine.state().position, engine.state().joint_velocity])

    np.testing.assert_array_equal(moved(), moved())


@pytest.fixture(scope="module")
def policy(tmp_path_factory) -> Policy:
    pytest.importorskip("onnx", reason="comes with the export extra")
    pytest.importorskip("onnxruntime", reason="comes with the export extra")
    return Policy(export_policy(policies_root() / "go2_camp", tmp_path_factory.mktemp("policy")).model)


def test_the_shipped_policy_trots(name, policy):
    engine = start_engine(name, description())
    done = walk(policy, EngineBody(engine, policy.metadata, Feet(GO2)), "trot_2hz", (0.6, 0.0, 0.0), 4.0)
    assert not done.fell and done.contact.shape == (800, 4) and done.foot_height.shape == (200, 4)
    found = judge(done, "trot_2hz", (0.6, 0.0, 0.0), policy.metadata["control_period"], 2.0)
    assert found.gait == "trot" and found.frequency_hz == pytest.approx(2.0, rel=0.15)
    assert found.velocity is not None and found.velocity[0] == pytest.approx(0.6, abs=0.2)


def test_feet_and_joints_are_seen_in_the_metadatas_order():
    names = metadata()["joint_names"][::-1]
    engine = start_engine("mujoco", description())
    body = EngineBody(engine, metadata() | {"joint_names": names}, Feet(GO2))
    assert body.joint_position[names.index("RR_calf_joint")] == pytest.approx(-1.8)
    assert body.gravity.tolist() == [0.0, 0.0, -1.0] and body.gravity.dtype == np.float32
    target = np.zeros(12, np.float32)
    target[names.index("FL_hip_joint")] = 0.5
    body.hold(target)
    assert engine.state().joint_velocity[JOINT_NAMES.index("FL_hip_joint")] > 0.1
    assert len(body.contact) == 4 and len(body.velocity) == 1
    heights = Feet(GO2).heights(np.array([0.0, 0.0, description().height]), np.eye(3), description().default_pose)
    np.testing.assert_allclose(heights, 0.0, atol=1e-9)


def test_forces_below_a_newton_are_no_contact():
    push = {"FL_foot": np.array([0.0, 0.6, 0.9]), "RR_foot": np.array([0.0, 0.0, 0.9]), "RL_calf": np.full(3, 9.0)}
    found = contacts_of(push, description())
    assert found.feet.tolist() == [True, False, False, False] and not found.fallen
    assert contacts_of({"FR_thigh": np.array([0.0, 0.0, 2.0])}, description()).fallen


def test_a_control_period_that_cannot_be_walked_is_an_error():
    with pytest.raises(CampError, match=r"control_period = 0.022: no multiple of 0.005 s"):
        EngineBody(start_engine("mujoco", description()), metadata() | {"control_period": 0.022}, Feet(GO2))


def test_engines_are_found_by_name_and_have_versions():
    assert engine_version("mujoco") == "4.0.0"
    with pytest.raises(ConfigError, match="engine = 'gazebo': unknown engine; choose one of mujoco, sapien"):
        find_engine("gazebo")


def test_an_engine_that_is_not_installed_is_one_line(monkeypatch):
    monkeypatch.delitem(sys.modules, "camp.transfer.dart_engine", raising=False)
    monkeypatch.setitem(sys.modules, "dartpy", None)
    with pytest.raises(CampError, match=r"package dartpy: not installed .*; install camp's extra `sim2sim`"):
        start_engine("dart", description())
