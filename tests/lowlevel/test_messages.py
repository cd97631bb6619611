"""What a reading says of the trunk."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.lowlevel.rig import joints, reading


def test_tilt_and_gravity_follow_the_roll():
    rolled = reading(tilt=0.5)
    assert rolled.tilt == pytest.approx(0.5, abs=1e-6)
    np.testing.assert_allclose(rolled.gravity, [0.0, -np.sin(0.5), -np.cos(0.5)], atol=1e-6)


@pytest.mark.parametrize("broken", [{"joint_velocity": joints(np.nan)}, {"attitude": np.zeros(4, np.float32)}])
def test_a_reading_with_a_missing_number_is_not_finite(broken):
    assert reading().finite and not replace(reading(), **broken).finite
