"""The figures of the expert's motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.motions import EXAMPLES, compute_traces, draw_examples, draw_gait, draw_motions, main
from camp.common.paths import assets_root
from camp.motion.clips.store import load_clip

FOLDER = assets_root() / "motions" / "go2"


@pytest.fixture(scope="module")
def clip():
    return load_clip(FOLDER / "trot_3hz_forward_0.6.npz")


def test_traces_are_the_clips(clip):
    traces = compute_traces(clip, "3 Hz", duration_s=1.0)
    assert traces.time[-1] == pytest.approx(1.0)
    np.testing.assert_array_equal(traces.contact, clip.foot_contact[:51])
    np.testing.assert_array_equal(traces.joint[3], clip.joint_position[3, :3])
    assert traces.velocity[:, 0].mean() == pytest.approx(0.6, abs=0.05)
    assert (traces.command == clip.command).all()
    assert set(traces.gait) == {"trot"}


def test_pitch_is_positive_nose_down(clip):
    half = np.sin(0.1), np.cos(0.1)  # .2 rad about y, x towards -z
    quaternion = np.tile(np.array([half[1], 0, half[0], 0], dtype=np.float32), (200, 1))
    assert compute_traces(replace(clip, base_quaternion=quaternion), "").pitch[0] == pytest.approx(0.2, abs=1e-6)


def test_a_transition_shows_both_gaits(clip):
    gait = compute_traces(replace(clip, previous_gait="pronk", switch_step=80), "").gait.tolist()
    assert (gait[79], gait[80]) == ("pronk", "trot")


def test_figures_have_a_panel_per_quantity(clip):
    traces = compute_traces(clip, "3 Hz")
    figure = draw_gait("trot", [traces, traces])
    assert len(figure.axes) == 10
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["FL", "FR", "RL", "RR"]
    assert len(draw_examples([traces, traces, traces]).axes) == 6


def test_missing_clips_are_named(tmp_path, capsys):
    assert main([str(tmp_path), str(tmp_path)]) == 2
    assert "trot_2hz_forward_0.6.npz' does not exist: generate" in capsys.readouterr().err


@pytest.mark.slow
def test_shipped_clips_are_drawn(tmp_path):
    paths = draw_motions(FOLDER, tmp_path)
    assert [path.stem for path in paths] == ["trot", "pace", "bound", "pronk", "examples"]
    assert all(path.stat().st_size > 20_000 for path in paths)
    assert len(EXAMPLES) == 4
