"""The method's data flow, with the sizes and weights of a run's own configuration (paper, Fig. 1)."""

from __future__ import annotations

from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from analysis.style import GREY, INK, PAGE, TERM_COLOURS, new_figure, style
from camp.algo.config import ImitationConfig
from camp.config.schema import Config
from camp.envs.observations import sizes
from camp.motion.clips.clip import TRAINING_SPLITS
from camp.robots.quadruped import NUM_JOINTS

POLICY, STYLE, SKILL, DATA = "#0072B2", TERM_COLOURS["style"], TERM_COLOURS["skill"], "#7A7A7A"


@dataclass(frozen=True)
class Box:
    """A part of the method. x, y: lower left corner in a plane of 100 x 46; lines: the first is its name."""

    x: float
    y: float
    width: float
    height: float
    colour: str
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Arrow:
    """What flows along straight lines through ``points``; the text stands at ``at``."""

    points: tuple[tuple[float, float], ...]
    text: str = ""
    at: tuple[float, float] = (0.0, 0.0)
    colour: str = INK


def compute_boxes(config: Config) -> dict[str, Box]:
    """The boxes, by what they are; a prior that is not built is left out."""
    algo, env, skills = config.algo, config.env, config.motion.skill_set()
    observed, privileged = sizes(env.observation, len(skills))
    state = "{} x {}".format(*env.transition_shape())
    condition = f" | z {algo.embedding_size}" if algo.style.conditional else ", no condition"
    targets = f"targets at {1.0 / env.control_period_s:.0f} Hz"
    boxes = {
        "command": Box(0, 33, 17, 11, DATA, ("command", "velocity 3", _skills_line(config))),
        "actor": Box(25, 33, 19, 11, POLICY, ("actor", _layers(observed, algo.actor.hidden, NUM_JOINTS))),
        "critic": Box(25, 17, 19, 10, POLICY, ("critic", _layers(observed + privileged, algo.critic.hidden, 1))),
        "robots": Box(53, 33, 19, 11, DATA, ("simulation", f"{config.sim.num_envs} robots", targets)),
        "expert": Box(80, 33, 20, 11, DATA, ("expert clips", _frequencies(config), ", ".join(TRAINING_SPLITS))),
        "ppo": Box(25, 1, 19, 10, POLICY, ("PPO", f"γ {algo.ppo.gamma:g}, λ {algo.ppo.gae_lambda:g}")),
    }
    if algo.imitation.epochs > 0:
        boxes["imitation"] = Box(0, 14, 17, 12, POLICY, ("imitation", *_imitation_lines(algo.imitation)))
    if algo.style.enabled:
        name = "style discriminator" if algo.style.conditional else "style discriminator (AMP)"
        boxes["style"] = Box(
            53,
            15,
            22,
            12,
            STYLE,
            (name, f"{state}{condition}", _layers(None, algo.style.hidden, 1), "LSGAN, eqs. 3, 4"),
        )
    if algo.skill.enabled:
        layers = _layers(None, algo.skill.hidden, algo.embedding_size)
        boxes["skill"] = Box(78, 15, 22, 12, SKILL, ("skill discriminator", state, layers, "cosine, eqs. 5 to 8"))
    if algo.style.conditional or algo.skill.enabled:
        boxes["embedding"] = Box(
            66, 1, 22, 8, STYLE, ("skill embedding z = E(y)", f"{len(skills)} x {algo.embedding_size}")
        )
    return boxes


def _imitation_lines(imitation: ImitationConfig) -> list[str]:
    lines = ["of the expert's targets", f"{imitation.epochs} epochs before PPO"]
    return [*lines, f"and beside it, {imitation.ppo_weight:g} x"] if imitation.ppo_weight > 0.0 else lines


def _skills_line(config: Config) -> str:
    count = len(config.motion.skill_set())
    return f"skill g, one of {count}" if config.env.observe_skill else "skill hidden"


def _frequencies(config: Config) -> str:
    hertz = ", ".join(f"{one:g}" for one in config.motion.frequencies_hz)
    return f"{len(config.motion.skills)} gaits, {hertz} Hz"


def _layers(inputs: int | None, hidden: list[int], outputs: int) -> str:
    sizes = [*([inputs] if inputs else []), *hidden, outputs]
    return " - ".join(map(str, sizes))


def compute_arrows(config: Config, boxes: dict[str, Box]) -> list[Arrow]:
    """What flows between the boxes that are there."""
    algo = config.algo
    arrows = [
        Arrow(((17, 38.5), (25, 38.5)), "c, g", (21, 39.6)),
        Arrow(((44, 38.5), (53, 38.5)), f"k a\nk = {config.robot.action_scale:g}", (48.5, 39.6)),
        Arrow(((60, 44), (60, 45.6), (34.5, 45.6), (34.5, 44)), "o", (47.5, 45.5), GREY),
        Arrow(((53, 35), (49, 35), (49, 22), (44, 22)), "o, x", (47, 23), GREY),
        Arrow(((34.5, 17), (34.5, 11)), "value", (37.5, 13.5)),
        Arrow(((25, 6), (21, 6), (21, 36), (25, 36)), "update", (18.3, 9), POLICY),
        Arrow(((49, 31), (49, 8), (44, 8)), f"task, {algo.task_weight:g} x", (45.2, 12.6)),
    ]
    if "imitation" in boxes:
        arrows.append(Arrow(((17, 20), (23, 20), (23, 34.5), (25, 34.5)), colour=POLICY))
    if "style" in boxes:
        arrows += [
            Arrow(((62, 33), (62, 27)), "policy's\nmotion", (58.6, 28), INK),
            Arrow(((84, 33), (84, 30), (70, 30), (70, 27)), "", colour=DATA),
            Arrow(((58, 15), (58, 5), (44, 5)), f"style, {algo.style.weight:g} x", (52.3, 6), STYLE),
        ]
    if "skill" in boxes:
        arrows += [
            Arrow(((90, 33), (90, 27)), "expert's motion", (95.3, 29), DATA),
            Arrow(((68, 33), (68, 31.5), (80, 31.5), (80, 27)), "", colour=INK),
            Arrow(
                ((96, 15), (96, -0.8), (50, -0.8), (50, 2.5), (44, 2.5)),
                f"skill, {algo.skill.weight:g} x",
                (60, -0.2),
                SKILL,
            ),
        ]
    if "embedding" in boxes:
        if "style" in boxes and algo.style.conditional:
            arrows.append(Arrow(((71, 9), (71, 15)), "z", (72, 11.4), STYLE))
        if "skill" in boxes:
            arrows.append(Arrow(((84, 9), (84, 15)), "target z", (87.6, 11.4), SKILL))
    return arrows


def draw_data_flow(config: Config) -> Figure:
    """Boxes and arrows; black: the policy's motion, grey: the expert's and what is measured."""
    boxes = compute_boxes(config)
    with style():
        figure = new_figure((PAGE, 3.45))
        axes = figure.subplots()
        axes.set(xlim=(-0.5, 100.5), ylim=(-2, 48))
        axes.set_axis_off()
        for arrow in compute_arrows(config, boxes):
            _draw_arrow(axes, arrow)
        for box in boxes.values():
            _draw_box(axes, box)
    return figure


def _draw_box(axes: Axes, box: Box) -> None:
    shape = FancyBboxPatch(
        (box.x, box.y), box.width, box.height, boxstyle="round,pad=0,rounding_size=0.8", linewidth=1.1
    )
    shape.set(edgecolor=box.colour, facecolor="white", zorder=3)
    axes.add_patch(shape)
    step = box.height / (len(box.lines) + 0.6)
    for row, line in enumerate(box.lines):
        y = box.y + box.height - (row + 0.8) * step
        weight, look = ("bold", 7.2) if row == 0 else ("normal", 6.3)
        axes.text(box.x + box.width / 2, y, line, ha="center", va="center", fontweight=weight, fontsize=look, zorder=4)


def _draw_arrow(axes: Axes, arrow: Arrow) -> None:
    *way, (before, last) = list(zip(arrow.points[:-1], arrow.points[1:], strict=True))
    for first, second in way:
        axes.plot([first[0], second[0]], [first[1], second[1]], color=arrow.colour, linewidth=1.0, zorder=1)
    head = {"arrowstyle": "-|>", "color": arrow.colour, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", last, before, arrowprops=head | {"mutation_scale": 8}, zorder=2)
    if arrow.text:
        axes.text(*arrow.at, arrow.text, ha="center", va="bottom", fontsize=6.5, color=arrow.colour)
