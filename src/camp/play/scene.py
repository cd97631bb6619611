"""The picture: the robot and the floor in viser's scene. The robot stays in the middle, the floor moves below it."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from camp.deployment.simulated import Robot
from camp.play.colours import LEG_COLOURS, PUSH_COLOUR, rgb
from camp.robots.quadruped import FOOT_NAMES
from camp.sim.rendering import COLLISION_GROUP

if TYPE_CHECKING:
    from viser import ViserServer

SQUARE_M = 0.5  # of the floor
EYE, LOOK_AT = (0.75, -1.15, 0.55), (0.0, 0.0, 0.2)  # m, from the ground below the robot
ARROW_S, ARROW_M = 0.6, 0.4  # how long a push is shown, and the arrow's length
FOOT_SCALE = 1.08  # its coloured ball around the foot


class Scene:
    """Draws one robot."""

    def __init__(self, server: ViserServer, robot: Robot):
        self._server, self._robot, self._model = server, robot, robot.model
        server.initial_camera.position, server.initial_camera.look_at = EYE, LOOK_AT
        server.scene.configure_environment_map("warehouse", environment_intensity=0.6)
        self._floor = server.scene.add_grid(
            "/floor",
            infinite_grid=True,
            cell_size=SQUARE_M,
            section_size=2 * SQUARE_M,
            fade_distance=12.0,
            shadow_opacity=0.35,
            plane_color=(236, 240, 244),
            plane_opacity=1.0,
        )
        self._bodies = {body: server.scene.add_frame(f"/{name}", show_axes=False) for body, name in self._shown()}
        self._add_shapes()
        self._arrow = server.scene.add_arrows(
            "/push",
            np.array([[[0.0, 0.0, 0.0], [0.0, ARROW_M, 0.0]]]),
            rgb(PUSH_COLOUR),
            shaft_radius=0.015,
            head_radius=0.035,
            head_length=0.09,
            visible=False,
        )
        self._arrow_until = 0.0

    def draw(self) -> None:
        """Show the robot where it is now."""
        data = self._robot.data
        ground = np.array([*data.qpos[:2], 0.0])  # below the robot
        with self._server.atomic():
            self._floor.position = np.mod(-ground, 2 * SQUARE_M)  # whole squares: the floor seems to stand still
            for body, frame in self._bodies.items():
                frame.position = data.xpos[body] - ground
                frame.wxyz = data.xquat[body]
            if self._arrow.visible and time.monotonic() > self._arrow_until:
                self._arrow.visible = False
        self._server.flush()

    def show_push(self, direction: tuple[float, float]) -> None:
        """Show an arrow for a moment. direction: unit vector in the world."""
        along = np.array([*direction, 0.0])
        height = np.array([0.0, 0.0, self._robot.data.qpos[2]])
        self._arrow.points = np.array([[height - (ARROW_M + 0.2) * along, height - 0.2 * along]], np.float32)
        self._arrow.visible = True
        self._arrow_until = time.monotonic() + ARROW_S

    def _shown(self) -> list[tuple[int, str]]:
        """Number and name of each body that has something to show."""
        bodies = sorted({int(self._model.geom_bodyid[geom]) for geom in self._shapes()})
        return [(body, self._model.body(body).name) for body in bodies]

    def _shapes(self) -> list[int]:
        """The robot's visible geoms."""
        model = self._model
        moving = model.geom_bodyid > 0
        return np.flatnonzero(moving & (model.geom_group != COLLISION_GROUP) & (model.geom_rgba[:, 3] > 0)).tolist()

    def _add_shapes(self) -> None:
        """One mesh for each body; each foot is a ball of its leg's colour in the diagram."""
        from mjviser.conversions import merge_geoms

        model, scene = self._model, self._server.scene
        feet = {model.geom(f"{leg}_foot").id: colour for leg, colour in zip(FOOT_NAMES, LEG_COLOURS, strict=True)}
        for body, name in self._shown():
            shapes = [geom for geom in self._shapes() if model.geom_bodyid[geom] == body]
            plain = [geom for geom in shapes if geom not in feet]
            if plain:
                scene.add_mesh_trimesh(f"/{name}/shape", merge_geoms(model, plain))
            for geom in set(shapes) & set(feet):
                radius = FOOT_SCALE * float(model.geom_size[geom, 0])
                scene.add_icosphere(f"/{name}/foot", radius, color=rgb(feet[geom]), position=model.geom_pos[geom])
