"""The training loop: what is collected, and that a resumed run equals an uninterrupted one bit for bit."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
import torch

from camp.build import build_training, load_run
from camp.common.errors import CheckpointError
from camp.config.resolve import as_yaml
from camp.config.schema import Config
from camp.runs.checkpoint import list_checkpoints, save_run_checkpoint
from camp.runs.logger import RunLogger
from camp.runs.state import TrainingState, load_state
from camp.runs.wandb_run import RunIdentity
from camp.training.collector import Collector
from camp.training.gait_monitor import GaitMonitor
from camp.training.progress import Progress
from camp.training.runner import Runner
from camp.training.warm_start import keep_imitating


def run_for(config: Config, folder: Path, saved: TrainingState | None = None, stop_after: int | None = None) -> Runner:
    training = build_training(config)
    keep_imitating(training, config)
    runner = Runner(training, config, folder)
    if saved is None:
        runner.start()
    else:
        runner.restore(saved)
    resume_from = None if saved is None else runner.iteration
    with (
        RunLogger(RunIdentity(folder, "test"), config.logger, as_yaml(config), resume_from) as logger,
        Progress(config.run.iterations, 1, stream=io.StringIO()) as progress,
    ):
        runner.train(logger, progress, lambda: stop_after is not None and runner.iteration >= stop_after)
    training.env.close()
    return runner


def metrics_of(folder: Path) -> list[dict]:
    rows = [json.loads(line) for line in (folder / "metrics.jsonl").read_text().splitlines()]
    return [{key: value for key, value in row.items() if not key.startswith("time/")} for row in rows]


@pytest.fixture
def busy(config: Config) -> Config:
    """Every source of randomness at work, replay included, and episodes that end."""
    config.env.noise.enabled = config.env.randomization.enabled = config.env.push.enabled = True
    config.env.episode_s = 0.4
    config.env.command.skill_period_s = 0.2
    config.algo.style.replay_size = 500
    config.env.transition_ages = [3, 1, 0]
    config.algo.ppo.symmetry_weight, config.env.observation.history = 0.5, 2
    config.algo.skill.patience_s = 0.1
    config.env.episode_growth.by_skill_from_s, config.env.command.skill_focus = 0.15, 0.5
    config.env.episode_growth.initial_s, config.env.episode_growth.doubling_s = 0.1, 2.0
    config.run.iterations, config.run.checkpoint_every = 6, 3
    return config


@pytest.mark.parametrize("imitating", [False, True])
def test_resumed_run_equals_an_uninterrupted_one(imitating, busy, tmp_path):
    if imitating:
        busy.motion.perturbed_folder, busy.motion.perturbed_clips = str(tmp_path / "clips"), 1
        busy.algo.imitation.epochs, busy.algo.imitation.ppo_weight = 1, 5.0
    straight, broken = tmp_path / "straight", tmp_path / "broken"
    for folder in (straight, broken):
        folder.mkdir()
    run_for(busy, straight)
    run_for(busy, broken, stop_after=3)
    run_for(busy, broken, load_state(broken))
    assert metrics_of(straight) == metrics_of(broken)
    assert (metrics_of(straight)[-1]["ppo/auxiliary_loss"] > 0.0) == imitating
    assert metrics_of(straight)[-1]["ppo/symmetry_loss"] > 0.0
    assert all(sum(row["prior/style/logit_histogram/expert"]) == pytest.approx(1.0) for row in metrics_of(straight))
    one, other = load_state(straight), load_state(broken)
    assert one.iteration == other.iteration == 6 and one.best == other.best
    for name, weights in one.actor.items():
        assert torch.equal(weights, other.actor[name]), name


@pytest.mark.parametrize("spoiled", ["policy", "critic", "style", "skill"])
def test_a_training_that_diverges_stops_and_keeps_its_good_checkpoints(spoiled, config, tmp_path, monkeypatch):
    config.run.iterations, config.run.checkpoint_every, config.run.checkpoints_kept = 8, 1, 3
    iterate = Runner.iterate

    def diverge(runner):
        metrics = iterate(runner)
        if runner.iteration == 3:
            ppo, priors = runner.training.ppo, {prior.name: prior for prior in runner.training.priors}
            network = {"policy": ppo.actor, "critic": ppo.critic}.get(spoiled) or priors[spoiled].networks()[0]
            with torch.no_grad():
                next(network.parameters()).view(-1)[0] = torch.nan
        return metrics

    monkeypatch.setattr(Runner, "iterate", diverge)
    with pytest.raises(
        CheckpointError, match=r"^iteration 3: training has diverged \(.*checkpoint_00000002\.pt"
    ) as caught:
        run_for(config, tmp_path)
    assert "\n" not in str(caught.value)
    assert [path.name for path in list_checkpoints(tmp_path)] == ["checkpoint_00000001.pt", "checkpoint_00000002.pt"]
    assert load_state(tmp_path).iteration == 2


def test_a_broken_checkpoint_is_not_continued(config, tmp_path):
    config.run.iterations, config.run.checkpoint_every = 2, 1
    run_for(config, tmp_path)
    state = load_state(tmp_path)
    next(iter(state.actor.values())).view(-1)[0] = torch.nan
    save_run_checkpoint(tmp_path, 3, state.as_dict(), keep=5)
    with pytest.raises(CheckpointError, match=r"00000003\.pt: training had diverged.*00000002\.pt"):
        load_state(tmp_path)


def test_looking_more_often_changes_nothing(busy, tmp_path):
    weights = []
    for every in (1, 100):
        folder = tmp_path / str(every)
        folder.mkdir()
        busy.run.gait_every, busy.run.iterations = every, 3
        weights.append(run_for(busy, folder).training.ppo.actor.state_dict())
    assert all(torch.equal(value, weights[1][name]) for name, value in weights[0].items())


def test_other_seeds_give_other_runs(busy, tmp_path):
    folders = [tmp_path / "a", tmp_path / "b"]
    for seed, folder in enumerate(folders):
        folder.mkdir()
        busy.seed, busy.run.iterations = seed, 2
        run_for(busy, folder)
    assert metrics_of(folders[0]) != metrics_of(folders[1])


def test_a_trained_run_loads_with_its_networks(config, tmp_path):
    config.run.iterations = 2
    runner = run_for(config, tmp_path)
    run = load_run(tmp_path)
    assert run.iteration == 2 and run.skills == ("trot", "pace", "bound", "pronk")
    observation = torch.randn(5, 49)
    torch.testing.assert_close(run.actor(observation), runner.training.ppo.actor(observation))
    state = runner.training.demonstrations.transition.take(slice(0, 7))
    prior = next(prior for prior in runner.training.priors if prior.name == "skill")
    torch.testing.assert_close(run.skill_prior.predict(state), prior.predict(state))


def test_a_run_in_bfloat16_is_evaluated_in_float32(config, tmp_path):
    config.algo.precision, config.run.iterations = "bfloat16", 2
    trained = run_for(config, tmp_path).training.ppo.actor
    loaded = load_run(tmp_path).actor
    assert trained.network.reduced and not loaded.network.reduced
    torch.testing.assert_close(loaded.network[0].weight, trained.network[0].weight)


def test_ablations_build_only_what_they_keep(config):
    config.algo.skill.enabled = False
    assert [prior.name for prior in build_training(config).priors] == ["style"]
    config.algo.style.enabled = False
    assert build_training(config).priors == []


def test_histograms_come_with_the_gait_readings_from_priors_that_have_them(config, tmp_path):
    config.run.iterations, config.run.gait_every = 2, 2
    for name, style in (("with", True), ("without", False)):
        (tmp_path / name).mkdir()
        config.algo.style.enabled = style
        run_for(config, tmp_path / name)
        found = [{key for key, value in row.items() if isinstance(value, list)} for row in metrics_of(tmp_path / name)]
        sides = {f"prior/style/logit_histogram/{side}" for side in ("expert", "policy")}
        assert found == [set(), sides if style else set()]


def test_mirror_images_double_the_demonstrations(config):
    plain = len(build_training(config).clips)
    config.motion.mirrored = True
    assert len(build_training(config).clips) == 2 * plain


def test_gaits_at_each_frequency_are_skills_of_their_own(config, tmp_path):
    config.motion.labels, config.run.iterations = "gait_frequency", 1
    config.motion.skills = ["trot", "bound"]
    runner = run_for(config, tmp_path)
    assert runner.training.env.observation.shape == (8, 45 + 4)
    assert load_run(tmp_path).skills == ("trot_2hz", "trot_3hz", "bound_2hz", "bound_3hz")


def test_time_outs_are_bootstrapped_with_the_final_observation(config):
    config.env.episode_s = 0.06  # every third step ends all episodes
    training = build_training(config)
    training.env.reset(seed=0, options={"stagger": False})
    monitor = GaitMonitor(config.motion.skill_set(), 8, 1.0, 0.02, training.device)
    finals = []
    advance = training.env.advance

    def spy(action, give_up):
        step = advance(action, give_up)
        finals.append((step.final_observation.clone(), step.final_privileged.clone()))
        return step

    training.env.advance = spy
    collector = Collector(training.env, training.ppo, monitor, training.device)
    rollout, _ = collector.collect(6, torch.Generator().manual_seed(0))
    assert rollout.truncated[2].any() and not rollout.truncated[1].any()
    for t in range(6):
        ended = rollout.truncated[t]
        expected = training.ppo.value(*finals[t])
        torch.testing.assert_close(rollout.next_value[t][ended], expected[ended])
    torch.testing.assert_close(rollout.next_value[0], rollout.value[1])


def test_rollout_shapes(config):
    training = build_training(config)
    training.env.reset()
    monitor = GaitMonitor(config.motion.skill_set(), 8, 1.0, 0.02, training.device)
    rollout, metrics = Collector(training.env, training.ppo, monitor, training.device).collect(
        4, torch.Generator().manual_seed(0)
    )
    shapes = {name: tuple(value.shape) for name, value in vars(rollout).items()}
    assert shapes["observation"] == (4, 8, 49) and shapes["transition"] == (4, 8, 2, 43)
    assert shapes["value"] == shapes["next_value"] == shapes["skill"] == (4, 8)
    assert metrics["reward/linear_velocity/raw"] <= 1.0
