"""The log tells rate, age and jitter."""

from __future__ import annotations

import csv

import pytest

from camp.common.errors import ConfigError
from camp.lowlevel.message_log import MessageLog, Row

ROWS = [Row(1.0 + 0.02 * k, "walking", "", "trot_2hz", 0.1 * k, 2.0, 20 * k, 1.0, 1) for k in range(11)]


def test_rows_are_written_and_summed_up(tmp_path):
    log = MessageLog(tmp_path / "new" / "log.csv")
    for row in ROWS:
        log.add(row)
    log.close()
    with (tmp_path / "new" / "log.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 11 and rows[3]["robot_ms"] == "60" and rows[3]["state"] == "walking"
    readings, commands, steps = log.summary().splitlines()
    assert readings.startswith("readings used: 50.0 per s; by the robot's clock between them 20.00")
    assert readings.endswith("older than the youngest by 0.00 (99 %: 0.00, most: 0.00) ms")
    assert commands.startswith("commands sent: 50.0 per s; between them 20.00")
    assert "late 0.50 (99 %: 0.99, most: 1.00) ms; work 2.00" in steps
    assert log.states == ["walking"]


def test_a_log_of_nothing_says_so():
    assert MessageLog(None).summary() == "no control step was made"


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="--log"):
        MessageLog(tmp_path / "file" / "log.csv")
