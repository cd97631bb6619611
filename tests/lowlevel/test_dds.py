"""A walk with gait switches over DDS: controller and simulated robot in processes of their own, in lockstep."""

from __future__ import annotations

import csv
import fcntl
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="comes with the go2 extra")
pytest.importorskip("unitree_sdk2py", reason="comes with the go2 extra")

from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait

SCRIPT = "0 stand, 3.6 walk, 3.6 velocity 0.5 0 0, 5.6 skill pace_3hz, 7.6 skill bound_3hz, 9.6 quit"
FIRST_DOMAIN, DOMAINS = 50, 150


@pytest.fixture
def domain():
    """A DDS domain that no other test on this computer is in."""
    for number in range(FIRST_DOMAIN, FIRST_DOMAIN + DOMAINS):
        with (Path(tempfile.gettempdir()) / f"camp_dds_domain_{number}_{os.getuid()}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            yield number
            return
    pytest.skip("every DDS domain for tests is taken")


def test_two_processes_walk_and_switch(shipped_path, domain, tmp_path):
    record, log = tmp_path / "record.npz", tmp_path / "log.csv"
    network = ["--interface", "lo", "--domain", str(domain), "--lockstep"]
    controls = ["--skill", "trot_3hz", "--script", SCRIPT, "--log", str(log)]
    with started("camp.go2_sim", *network, "--record", str(record)) as robot:
        assert robot.stdout is not None and "simulated go2 on lo" in robot.stdout.readline()
        with started("camp.go2", str(shipped_path), *network, *controls) as controller:
            told, _ = controller.communicate()
            assert controller.returncode == 0, told
            last, _ = robot.communicate()
    assert robot.returncode == 0 and "at rest" in last and "lost 0, damaged 0" in last
    assert "readings used: 50.0 per s" in told
    with np.load(record, allow_pickle=False) as found:
        time_s, contact, tilt = found["time_s"], found["contact"], found["tilt_rad"]
    assert tilt.max() < 0.5
    shown = []
    for begin, end in ((4.2, 5.6), (6.2, 7.6), (8.2, 9.6)):
        walked = contact[(time_s >= begin) & (time_s < end)]
        shown.append(measure_gait(debounced(walked[None], 0.02), 0.02).label[0])
    assert shown == ["trot", "pace", "bound"]
    with log.open() as file:
        rows = list(csv.DictReader(file))
    states = [row["state"] for row in rows]
    assert sorted(set(states), key=states.index) == ["standing up", "standing", "walking", "lying down", "passive"]
    assert {row["fault"] for row in rows} == {""} and {row["fresh"] for row in rows} == {"1"}


@contextmanager
def started(module: str, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A process of its own that does not outlive the test."""
    command = [sys.executable, "-m", module, *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()
