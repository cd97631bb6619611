"""The web page's modules do what Python does: its own tests, run by Node, with Python's answers to compare with.

`python -m pytest tests/test_web.py -n 0 -rP` prints how far they agree. `make web-check` tries the page in a browser.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camp import deploy
from camp.common.errors import ConfigError
from camp.common.paths import policies_root
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import Skill, performed, split_name
from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait
from camp.robots.registry import find_robot
from web.inputs import main, write_inputs

pytest.importorskip("onnx", reason="comes with the export extra")
pytest.importorskip("onnxruntime", reason="comes with the export extra")

WEB = Path(__file__).parents[1] / "web"
SHIPPED = policies_root() / "go2_camp"
PERIOD = 0.02  # s
COMMAND = (0.6, 0.0, 0.0)
SECONDS = 4.0


@pytest.fixture(scope="module")
def inputs(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    write_inputs(SHIPPED, folder)
    return folder


def contacts() -> list[np.ndarray]:
    """Sequences (T, 4) of every gait, at several rates, duties and lengths; with bounces; and some of no gait."""
    rng = np.random.default_rng(0)
    found = []
    for phases in GAIT_PHASES.values():
        for steps in (50, 100, 187, 250):
            stride = np.arange(steps)[:, None] * PERIOD * rng.uniform(1.5, 4.0) + rng.random()
            stands = np.mod(stride - phases, 1.0) < rng.uniform(0.4, 0.65)
            found += [stands, stands & (rng.random(stands.shape) > 0.05)]
    return [*found, rng.random((50, 4)) < 0.5, np.ones((50, 4), bool), np.zeros((50, 4), bool)]


def plain(value: np.ndarray) -> Any:
    """As JSON knows it: null in place of nan."""
    value = np.asarray(value)
    return np.where(np.isnan(value), None, value).tolist() if value.dtype.kind == "f" else value.tolist()


def gaits() -> list[dict[str, Any]]:
    """What `camp.metrics` measures of each sequence."""
    found = []
    for raw in contacts():
        contact = debounced(raw, PERIOD)
        answer = vars(measure_gait(contact[None], PERIOD))
        measured = {name: plain(value[0]) for name, value in answer.items()}
        found.append({"raw": raw.tolist(), "debounced": contact.tolist(), "measured": measured})
    return found


def observations(policy: deploy.Policy) -> list[dict[str, Any]]:
    """States of a walk with the observation that `camp.deploy` makes of each, and the policy's answer."""
    metadata, robot = policy.metadata, deploy.Robot(policy.metadata)
    pose = np.array(metadata["default_pose"], np.float32)
    command, last_action = np.array([0.5, -0.1, 0.3], np.float32), np.zeros_like(pose)
    found: list[dict[str, Any]] = []
    frames: list[deploy.Array] = []
    for step in range(25):
        skill = metadata["skills"][step % len(metadata["skills"])]
        observation = deploy.observe(policy, robot, command, policy.one_hot(skill), last_action)
        frames = policy.remembered(frames, observation)
        target = policy.joint_target(np.concatenate(frames))
        state = {"qpos": robot.data.qpos, "qvel": robot.data.qvel, "command": command, "last_action": last_action}
        answer = {"observation": observation, "joint_target": target, "velocity": robot.velocity}
        found.append({"skill": skill} | {name: value.tolist() for name, value in (state | answer).items()})
        robot.hold(target)
        last_action = (target - pose) / np.float32(metadata["action_scale"])
    return found


def walks(policy: deploy.Policy) -> list[dict[str, Any]]:
    """Every skill from standing: where the robot was at each step, and what the last second's contacts show."""
    skills = [Skill(*split_name(name)) for name in policy.metadata["skills"]]
    last = slice(-round(1.0 / PERIOD), None)
    found = []
    for skill in skills:
        done = deploy.walk(policy, skill.name, COMMAND, SECONDS)
        gait = measure_gait(debounced(done.contact, PERIOD)[None, last], PERIOD)
        assert performed(gait.label, gait.frequency_hz, skills)[0] == skill.name
        found.append(
            {
                "skill": skill.name,
                "qpos": done.qpos.tolist(),
                "frequency_hz": float(gait.frequency_hz[0]),
                "velocity": done.velocity[last].mean(axis=0).tolist(),
            }
        )
    return found


def test_the_modules_agree_with_python(inputs):
    if shutil.which("node") is None:
        pytest.skip("node is not installed; the web page's tests need 20 or newer")
    version = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout
    if int(version.lstrip("v").split(".")[0]) < 20:
        pytest.skip(f"node is {version.strip()}; the web page's tests need 20 or newer")
    if not (WEB / "node_modules" / ".package-lock.json").is_file():
        pytest.skip("npm's packages are not there; `make web` installs them")
    policy = deploy.Policy(inputs / "policy.onnx")
    golden = {
        "command": COMMAND,
        "seconds": SECONDS,
        "gaits": gaits(),
        "observations": observations(policy),
        "walks": walks(policy),
    }
    (inputs / "golden.json").write_text(json.dumps(golden))
    command = ["node", "--test", "--test-reporter=tap", *map(str, sorted((WEB / "tests").glob("*.test.js")))]
    environment = os.environ | {"CAMP_WEB_INPUTS": str(inputs)}
    done = subprocess.run(command, cwd=WEB, env=environment, capture_output=True, text=True)
    print("\n".join(line for line in done.stdout.splitlines() if line.lstrip().startswith(("# ", "ok", "not ok"))))
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    assert "# skipped 0" in done.stdout


def test_the_inputs_are_the_projects_own(inputs):
    assert {path.name for path in inputs.iterdir()} >= {"policy.onnx", "policy.json", "robot.xml", "rules.json"}
    robot = find_robot(deploy.Policy(inputs / "policy.onnx").metadata["robot"])
    assert (inputs / "robot.xml").read_bytes() == robot.model_path.read_bytes()
    rules = json.loads((inputs / "rules.json").read_text())
    assert {gait["name"]: tuple(gait["phases"]) for gait in rules["gaits"]} == GAIT_PHASES
    assert rules["fall_tilt_rad"] == deploy.FALL_TILT


def test_a_run_that_is_missing_is_one_line(tmp_path):
    with pytest.raises(ConfigError, match="output=<value> is missing"):
        main([f"run={tmp_path}"])


@pytest.mark.parametrize("path", sorted(WEB.glob("src/*.js")), ids=lambda path: path.name)
def test_every_module_is_small_and_says_what_it_is_for(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 250
    assert "/**" in text or path.name == "main.js"


def test_the_page_asks_no_other_host():
    for path in [*WEB.glob("src/*.js"), WEB / "index.html", WEB / "style.css"]:
        hosts = set(re.findall(r"(?:https?:|['\"`(])//([\w.-]+)", path.read_text(encoding="utf-8")))
        assert hosts <= {"www.w3.org"}, path.name  # the name of SVG, which nobody loads
