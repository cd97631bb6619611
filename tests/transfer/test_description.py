"""The URDF is the MuJoCo model: masses, inertias, kinematics and joints, as other readers of URDF understand it."""

from __future__ import annotations

from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from camp.common.errors import CampError
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from camp.robots.robot import Robot
from camp.transfer.description import describe, fused_model, urdf_of
from tests.transfer.descriptions import A1, GO2, description, metadata

TOLERANCE = 1e-6
LIMITS = dict.fromkeys(JOINT_NAMES, 1.0)
MASS = {"go2": 15.206408, "a1": 12.776}  # kg


@pytest.fixture(scope="module", params=[GO2, A1], ids=lambda robot: robot.name)
def robot(request) -> Robot:
    return request.param


@pytest.fixture(scope="module")
def read(robot) -> mujoco.MjModel:
    """The URDF as MuJoCo reads it, floating as the original does; shapes keep their names."""
    root = ElementTree.fromstring(description(robot).urdf)
    options = ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler")
    options.attrib = {"fusestatic": "false", "discardvisual": "false", "balanceinertia": "false"}
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.body("base").add_freejoint()
    return spec.compile()


def posed(model: mujoco.MjModel, joints: np.ndarray) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:7] = [0.1, 0.2, 0.3, 0.8, 0.0, 0.6, 0.0]
    data.qpos[[model.joint(name).qposadr[0] for name in JOINT_NAMES]] = joints
    mujoco.mj_forward(model, data)
    return data


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """Without the rotors, base first, then the joints in their order."""
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    full -= np.diag(model.dof_armature)
    order = [*range(6), *(int(model.joint(name).dofadr[0]) for name in JOINT_NAMES)]
    return full[np.ix_(order, order)]


def test_masses_and_inertias_are_the_models(robot, read):
    original = fused_model(robot)
    assert read.nbody == original.nbody == 14
    for number in range(1, original.nbody):
        name = original.body(number).name
        for key in ("mass", "ipos"):
            np.testing.assert_allclose(
                getattr(read.body(name), key), getattr(original.body(name), key), rtol=0, atol=TOLERANCE
            )
    assert read.body_subtreemass[0] == pytest.approx(robot.load_model().body_subtreemass[0], abs=TOLERANCE)
    assert read.body_subtreemass[0] == pytest.approx(MASS[robot.name], abs=TOLERANCE)


def test_the_mass_matrix_is_the_models_in_any_pose(robot, read):
    """Holds masses, centres, inertias, axes and offsets of all links at once."""
    original, random = fused_model(robot), np.random.default_rng(0)
    for _ in range(20):
        joints = random.uniform(robot.joint_lower, robot.joint_upper)
        found, wanted = mass_matrix(read, posed(read, joints)), mass_matrix(original, posed(original, joints))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=TOLERANCE)


def test_the_feet_are_where_the_whole_models_feet_are(robot, read):
    original, random = robot.load_model(), np.random.default_rng(1)
    for _ in range(20):
        joints = random.uniform(robot.joint_lower, robot.joint_upper)
        found, wanted = posed(read, joints), posed(original, joints)
        for foot in FOOT_NAMES:
            at = found.geom(f"{foot}_foot").xpos
            np.testing.assert_allclose(at, wanted.geom(f"{foot}_foot").xpos, rtol=0, atol=TOLERANCE)


def test_joints_have_the_models_ranges_damping_and_friction(robot, read):
    original = robot.load_model()
    for name in JOINT_NAMES:
        found, wanted = read.joint(name), original.joint(name)
        np.testing.assert_allclose(found.range, wanted.range, rtol=0, atol=TOLERANCE)
        assert found.damping[0] == pytest.approx(wanted.damping[0])
        assert found.frictionloss[0] == pytest.approx(wanted.frictionloss[0])


def test_drake_reads_the_same_mass_matrix(robot):
    """A reader of URDF, and a dynamics of its own, that have nothing of MuJoCo."""
    plants = pytest.importorskip("pydrake.multibody.plant", reason="comes with the sim2sim extra")
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = plants.MultibodyPlant(0.0)
    root = ElementTree.fromstring(description(robot).urdf)
    for dynamics in root.iter("dynamics"):
        dynamics.attrib.pop("friction")
    parsing.Parser(plant).AddModelsFromString(ElementTree.tostring(root, encoding="unicode"), "urdf")
    plant.Finalize()
    context, original = plant.CreateDefaultContext(), fused_model(robot)
    assert plant.CalcTotalMass(context) == pytest.approx(original.body_subtreemass[0], abs=TOLERANCE)
    order = [plant.GetJointByName(name).velocity_start() for name in JOINT_NAMES]
    for joints in np.random.default_rng(2).uniform(robot.joint_lower, robot.joint_upper, (5, 12)):
        for name, angle in zip(JOINT_NAMES, joints, strict=True):
            plant.GetJointByName(name).set_angle(context, angle)
        found = plant.CalcMassMatrix(context)[np.ix_(order, order)]
        wanted = mass_matrix(original, posed(original, joints))[6:, 6:]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=TOLERANCE)


def test_a_capsule_is_a_cylinder_and_two_spheres():
    root = ElementTree.fromstring(description().urdf)
    (thigh,) = [link for link in root.iter("link") if link.get("name") == "RL_thigh"]
    shapes = {one.attrib["name"]: one for one in thigh.iter("collision")}
    assert list(shapes) == ["RL_thigh", "RL_thigh_end-1", "RL_thigh_end+1"]
    heights = sorted(float(one.find("origin").attrib["xyz"].split()[2]) for one in shapes.values())
    assert heights == pytest.approx([-0.19, -0.11, -0.03])
    cylinder = shapes["RL_thigh"].find("geometry/cylinder").attrib
    assert (float(cylinder["radius"]), float(cylinder["length"])) == pytest.approx((0.022, 0.16))


def test_every_shape_belongs_to_a_foot_or_to_its_link():
    parts = description().parts
    assert parts["base"] == {"trunk": "base", "head": "base"}
    assert parts["FR_calf"]["FR_foot"] == "FR_foot" and parts["FR_calf"]["FR_calf"] == "FR_calf"
    assert set(parts["RL_thigh"].values()) == {"RL_thigh"} and parts["RL_hip"] == {}


def test_gains_and_pose_are_taken_by_name():
    names = metadata()["joint_names"][::-1]
    found = describe(GO2, metadata() | {"joint_names": names, "kp": list(range(12)), "kd": [1.0] * 11 + [2.0]})
    assert found.kp.tolist() == list(range(12))[::-1] and found.kd[0] == 2.0
    assert description().torque_limit.tolist() == list(GO2.torque_limit)
    assert description().height == pytest.approx(0.28837, abs=1e-5)


def test_a_shape_without_a_place_in_a_urdf_is_an_error():
    spec = GO2.load_spec()
    spec.body("base").add_geom(name="egg", type=mujoco.mjtGeom.mjGEOM_ELLIPSOID, size=[0.1, 0.1, 0.2], conaffinity=1)
    with pytest.raises(CampError, match="geom egg: shape ellipsoid has no place"):
        urdf_of(spec.compile(), "go2", LIMITS)
