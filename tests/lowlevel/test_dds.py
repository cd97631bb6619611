"""A walk with switches over DDS: the controller here, the simulated robot in a process of its own, in lockstep."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="comes with the go2 extra")
pytest.importorskip("unitree_sdk2py", reason="comes with the go2 extra")

from camp import go2
from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait

SCRIPT = "0 stand, 3.6 walk, 3.6 velocity 0.5 0 0, 5.6 skill pace_3hz, 7.6 quit"
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


def test_two_processes_walk_and_switch(shipped_path, domain, tmp_path, capfd):
    record, log = tmp_path / "record.npz", tmp_path / "log.csv"
    network = ["--interface", "lo", "--domain", str(domain), "--lockstep"]
    robot = subprocess.Popen([sys.executable, "-m", "camp.go2_sim", *network, "--record", str(record)])
    try:
        code = go2.main([str(shipped_path), *network, "--skill", "trot_3hz", "--script", SCRIPT, "--log", str(log)])
        assert (code, robot.wait()) == (0, 0)
    finally:
        robot.kill()
    said = capfd.readouterr().out
    assert "passive" in said and "at rest" in said and "lost 0, damaged 0" in said
    with np.load(record, allow_pickle=False) as found:
        time_s, contact, tilt = found["time_s"], found["contact"], found["tilt_rad"]
    assert tilt.max() < 0.5
    shown = []
    for begin, end in ((4.2, 5.6), (6.2, 7.6)):
        walked = contact[(time_s >= begin) & (time_s < end)]
        shown.append(measure_gait(debounced(walked[None], 0.02), 0.02).label[0])
    assert shown == ["trot", "pace"]
    assert len(log.read_text().splitlines()) > 400
