"""The best checkpoint is the one whose gaits were read best, and it outlives newer ones."""

from __future__ import annotations

from camp.runs.checkpoint import list_checkpoints, save_run_checkpoint
from camp.training.best import BestCheckpoint


def test_the_latest_reading_before_a_checkpoint_counts():
    best = BestCheckpoint(num_skills=2)
    best.saved(1)
    assert best.iteration is None  # nothing was read yet
    best.read({"gait/trot_2hz/accuracy": 0.5, "gait/pace_2hz/accuracy": 0.7, "gait/stepping": 1.0})
    best.saved(2)
    best.read({"gait/trot_2hz/accuracy": 0.9, "gait/pace_2hz/accuracy": 0.9, "reward/task/raw": 5.0})
    best.read({"ppo/kl": 0.1})  # an iteration without a reading
    best.saved(3)
    best.read({"gait/trot_2hz/accuracy": 1.0})  # no robot paced for long enough: the mean is a half
    best.saved(4)
    assert best.iteration == 3
    state = {"reading": 0.5, "difficulty": 1.0, "iteration": 3.0, "score": 0.9, "best_difficulty": 1.0}
    assert best.state_dict() == state


def test_harder_conditions_count_for_more_than_any_accuracy_under_easier_ones():
    best, gait = BestCheckpoint(1), "gait/trot/accuracy"
    for iteration, difficulty, accuracy in [(1, 0.0, 1.0), (2, 0.5, 0.8), (3, 0.5, 0.7), (4, 0.25, 1.0)]:
        best.read({gait: accuracy, "env/difficulty": difficulty})
        best.saved(iteration)
    assert best.iteration == 2


def test_of_equal_ones_the_newest_and_a_continued_run_goes_on():
    first, second = BestCheckpoint(1), BestCheckpoint(1)
    first.read({"gait/trot/accuracy": 1.0})
    first.saved(5)
    second.load_state_dict(first.state_dict())
    second.saved(6)
    assert (first.iteration, second.iteration) == (5, 6)


def test_a_state_from_before_the_difficulty_keeps_its_best():
    best = BestCheckpoint(1)
    best.load_state_dict({"reading": 0.9, "iteration": 3.0, "score": 0.95})
    best.saved(4)
    assert best.iteration == 3
    best.read({"gait/trot/accuracy": 0.96})
    best.saved(5)
    assert best.iteration == 5


def test_not_a_number_is_no_best():
    best = BestCheckpoint(1)
    best.read({"gait/trot/accuracy": float("nan")})
    best.saved(1)
    assert best.iteration is None


def test_rotation_spares_the_best(tmp_path):
    for iteration in range(1, 8):
        save_run_checkpoint(tmp_path, iteration, {"iteration": iteration}, keep=2, best=3)
    assert [path.stem[-1] for path in list_checkpoints(tmp_path)] == ["3", "6", "7"]
