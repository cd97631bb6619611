"""Fixtures shared by all tests."""

from __future__ import annotations

import signal
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import torch

from camp.build import build_robot, motion_folder
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clips

# A shell starts a command in the background with Ctrl-C ignored, and so would every command that the tests interrupt.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--kills", type=int, default=2, help="of each phase of the fault campaign (docs/reliability.md)")


@pytest.hookimpl(optionalhook=True)  # pytest-xdist's
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """With `--dist loadfile`: a file's tests in one worker, and all files with tests of DTW in the same one."""
    from xdist.scheduler import LoadFileScheduling

    class OneCompilation(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            scope = super()._split_scope(nodeid)
            return "dtw" if compiles_dtw(config.rootpath / scope) else scope

    return OneCompilation(config, log) if config.getvalue("dist") == "loadfile" else None


@cache
def compiles_dtw(path: Path) -> bool:
    """Whether a file has tests that are marked so."""
    return "pytest.mark.dtw" in path.read_text(encoding="utf-8")


@pytest.fixture(scope="session", autouse=True)
def _one_thread():
    """Two busy thread pools on two cores slow each other down."""
    torch.set_num_threads(1)


@pytest.fixture
def config() -> Config:
    """conf/train.yaml with few robots and without sensor noise, pushes and randomization."""
    return compose_config(
        [
            "run=smoke",
            "sim=cpu",
            "sim.num_envs=8",
            "sim.threads=1",
            "logger.wandb_mode=disabled",
            "env.noise.enabled=false",
            "env.push.enabled=false",
            "env.randomization.enabled=false",
        ]
    )


@pytest.fixture(scope="session")
def clips() -> list[Clip]:
    """The shipped clips."""
    shipped = compose_config([])
    return load_clips(build_robot(shipped.robot), motion_folder(shipped), shipped.motion.skills)
