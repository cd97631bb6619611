"""Pictures and videos of the robot, rendered without a display (``MUJOCO_GL=egl`` or ``osmesa``)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import imageio.v2 as imageio
import mujoco
import numpy as np

from camp.common.errors import CampError

COLLISION_GROUP = 3  # geoms that are felt but not shown
SHADOW_SIZE = 2048  # pixels of the shadows' map; the model's 4096 take nearly twice the time without a GPU
SMOOTH_SAMPLES = 4  # of each pixel


class RobotRenderer:
    """Draws one robot from its generalized position.

    Args:
        model: the robot's model.
        width, height: pixels; even numbers, as video codecs want.
        smooth: without steps along edges; takes two to three times as long without a GPU.

    Of ``model`` it changes what concerns pictures alone.

    Raises:
        CampError: where no off-screen OpenGL is to be had.
    """

    def __init__(self, model: mujoco.MjModel, width: int = 640, height: int = 480, smooth: bool = False):
        self._model = model
        self._data = mujoco.MjData(model)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[COLLISION_GROUP] = 0
        model.vis.quality.shadowsize = SHADOW_SIZE
        model.vis.quality.offsamples = SMOOTH_SAMPLES if smooth else 0
        try:
            self._renderer = mujoco.Renderer(model, height, width)
        except (RuntimeError, ImportError, AttributeError, mujoco.FatalError) as error:
            raise CampError(
                f"rendering: no off-screen OpenGL ({error}); install libegl1 and libgl1-mesa-dri and set "
                "MUJOCO_GL=egl, or libosmesa6 and MUJOCO_GL=osmesa"
            ) from error

    def frame(self, qpos: np.ndarray) -> np.ndarray:
        """(height, width, 3) uint8 picture of the robot at ``qpos`` (19,), from the tracking camera."""
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        # Every light's axis goes through the robot: only near it shadows are computed, beyond the ground is dark.
        axis = self._data.light_xdir
        self._data.light_xpos[:, :2] = qpos[:2] + self._data.light_xpos[:, 2:] * axis[:, :2] / axis[:, 2:]
        self._renderer.update_scene(self._data, camera="track", scene_option=self._option)
        return self._renderer.render()

    def close(self) -> None:
        self._renderer.close()


def write_video(path: Path, frames: Iterable[np.ndarray], frames_per_second: float) -> None:
    """Write frames (height, width, 3) uint8 as an H.264 mp4, which takes its name once it is whole."""
    partial = path.with_name(f".{path.stem}.partial.mp4")
    try:
        with imageio.get_writer(
            partial, fps=frames_per_second, codec="libx264", quality=7, macro_block_size=2
        ) as writer:
            for frame in frames:
                writer.append_data(frame)  # pyright: ignore[reportAttributeAccessIssue]
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
