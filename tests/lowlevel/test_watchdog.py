"""The robot's side holds, lies down and damps, and does not wake up again."""

from __future__ import annotations

import numpy as np

from camp.lowlevel.messages import Command
from camp.lowlevel.motion import DROP_S, FOLDED, REST_S
from camp.lowlevel.watchdog import Watchdog
from tests.lowlevel.rig import joints

COMMAND = Command(joints(0.5), joints(30.0), joints(1.0))


def test_without_a_limit_the_last_command_is_held():
    watchdog = Watchdog()
    assert watchdog.command(0.0, None) is None
    watchdog.command(0.0, COMMAND)
    assert watchdog.command(1e6, None) is COMMAND and not watchdog.acted


def test_silence_ends_in_damping_over_lying_down():
    watchdog = Watchdog(0.1)
    watchdog.command(1.0, COMMAND)
    assert watchdog.command(1.09, None) is COMMAND
    lying = watchdog.command(1.2, None)
    assert lying is not None and lying.kp.all() and watchdog.acted
    end = watchdog.command(1.1 + DROP_S + REST_S - 0.001, None)
    assert end is not None
    np.testing.assert_allclose(end.target, FOLDED, atol=1e-3)
    damped = watchdog.command(1.1 + DROP_S + REST_S + 0.001, None)
    assert damped is not None and not damped.kp.any()


def test_commands_that_come_back_too_late_do_not_count():
    watchdog = Watchdog(0.1)
    watchdog.command(0.0, COMMAND)
    watchdog.command(0.2, None)
    late = watchdog.command(5.0, COMMAND)
    assert late is not None and not late.kp.any()
