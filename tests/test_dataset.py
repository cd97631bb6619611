"""`python -m camp.dataset`: how it ends, what it prints, and that it loses nothing."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest

from camp import dataset
from camp.common.files import folder_lock
from camp.common.paths import assets_root
from camp.dataset import main
from camp.motion.clips.store import load_clip, save_clip
from tests.errors import assert_one_line

FOLDER = assets_root() / "motions" / "go2"
NAMES = ("bound_2hz_backward_0.3_turn_left_0.4", "trot_2hz_forward_0.6", "pace_2hz_in_place")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in NAMES:
        shutil.copy(FOLDER / f"{name}.npz", tmp_path)
    return tmp_path


def test_validation_is_readable_at_80_columns(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = replace(load_clip(FOLDER / "trot_2hz_forward_0.6.npz"), gait="pace")
    save_clip(folder / "zz_wrong.npz", wrong)
    assert main(["validate", str(folder)]) == 1
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines()[:-1])) <= 80  # but for the last line, which names the folder
    assert out.index("what fails") < out.index("worst of each criterion")
    failing = [line for line in out[: out.index("worst of")].splitlines() if line.startswith(" zz_wrong")]
    assert any("contact match" in line for line in failing)
    assert "4 clips, 1 bad; every clip's values: --all" in out
    assert main(["validate", str(folder), "--all"]) == 1
    listed = capsys.readouterr().out.removeprefix(out[: out.index("4 clips")])
    assert max(map(len, listed.splitlines()[:-1])) <= 80
    for name in (*NAMES, "zz_wrong"):
        assert listed.count(f" {name} ") > 5  # once in every block of criteria
    assert listed.rindex(" zz_wrong ") < listed.rindex(f" {NAMES[0]} ")  # failures first


def test_validation_of_the_smallest_clip(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clip = load_clip(folder / "trot_2hz_forward_0.6.npz")
    rows = {name: value[:5] for name, value in vars(clip).items() if getattr(value, "shape", ())[:1] == (200,)}
    save_clip(folder / "short.npz", replace(clip, **rows))
    assert main(["validate", str(folder)]) in (0, 1)
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["import"], "the following arguments are required: file, --format, --gait"),
        (["import", "x", "--format", "bvh", "--gait", "trot"], "argument --format: invalid choice"),
        (["import", "none.txt", "--format", "amp", "--gait", "trot"], "motion none.txt does not exist"),
        (["import", ".", "--format", "amp", "--gait", "trot"], "motion . does not exist; pass the path of a file"),
        (["export", "none.npz", "--format", "amp", "x.txt"], "clip none.npz does not exist"),
        (["card", "none"], "no clips in none"),
        (["validate", "none"], "no clips in none"),
        (["perturbed", "--count", "-1"], "argument --count: '-1': pass a whole number from 1 to 100000"),
        (["perturbed", "--count", "1e9"], "argument --count: '1e9': pass a whole number from 1 to 100000"),
        (["--workers", "0"], "argument --workers: '0': pass a whole number from 1 to 1024"),
        (["--folder", "/dev/null/clips"], "output folder /dev/null/clips: Not a directory"),
        (["--no-such-option"], "unrecognized arguments: --no-such-option; see --help"),
    ],
)
def test_bad_command_lines_are_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert_one_line(capsys.readouterr().err, message)


def test_a_card_does_not_replace_another_readme(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "README.md").write_text("mine")
    assert main(["card", str(folder)]) == 2
    assert_one_line(capsys.readouterr().err, "was not written by this command; move it away")
    assert (folder / "README.md").read_text() == "mine"
    (folder / "README.md").unlink()
    assert [main(["card", str(folder)]) for _ in range(2)] == [0, 0]  # its own it replaces


def test_a_card_of_unreadable_clips(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "clip.npz").write_bytes(b"cut off")
    assert main(["card", str(tmp_path)]) == 2
    assert "no clip in" in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "README.md").exists()


def test_a_card_of_imported_motion(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clip = load_clip(folder / "trot_2hz_forward_0.6.npz")
    save_clip(folder / "imported.npz", replace(clip, frequency_hz=1.9871, source="amp", split="varied"))
    main(["card", str(folder)])
    assert "Traceback" not in capsys.readouterr().err and (folder / "README.md").is_file()


@pytest.mark.parametrize("command", ["validate", "card", "import", "export"])
def test_ctrl_c_ends_every_command_in_one_word(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    def interrupt(*_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(dataset, "judge", interrupt)
    monkeypatch.setattr(dataset, "run_exchange", interrupt)
    rest = {
        "import": ["x", "--format", "amp", "--gait", "trot"],
        "export": ["x", "--format", "amp", "y"],
    }.get(command, [str(folder)])
    assert main([command, *rest]) == 130
    assert capsys.readouterr().err == "interrupted\n"


def start(*arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "camp.dataset", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


@pytest.mark.slow
def test_ctrl_c_while_generating(tmp_path: Path) -> None:
    """As a terminal does it: the signal goes to all processes at once."""
    process = start("perturbed", "--folder", tmp_path, "--count", 40, "--workers", 2)
    while not list(tmp_path.glob("*.npz")) and process.poll() is None:
        time.sleep(0.2)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert err == "interrupted\n"
    for path in tmp_path.glob("*.npz"):
        load_clip(path)


@pytest.mark.slow
def test_two_that_generate_the_same_clips(tmp_path: Path) -> None:
    both = [start("perturbed", "--folder", tmp_path, "--count", 2, "--workers", 1) for _ in range(2)]
    outs = [process.communicate() for process in both]
    assert [process.returncode for process in both] == [0, 0]
    assert sorted(out.splitlines()[-1].split(": ")[1].split(",")[0] for out, _ in outs) == ["0 made", "2 made"]
    assert sum("waiting for another process" in out for out, _ in outs) == 1
    assert {path.suffix for path in tmp_path.iterdir()} == {".npz"}


@pytest.mark.slow
def test_output_that_nobody_reads(folder: Path) -> None:
    process = start("validate", folder)
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == ""
    process.wait()


def test_a_folder_has_one_writer(tmp_path: Path) -> None:
    entered: list[float] = []

    def second() -> None:
        with folder_lock(tmp_path / "clips"):
            entered.append(time.monotonic())

    with folder_lock(tmp_path / "clips"):
        thread = threading.Thread(target=second)
        thread.start()
        time.sleep(0.3)
        left = time.monotonic()
        assert not entered
    thread.join()
    assert entered and entered[0] >= left
    assert list((tmp_path / "clips").iterdir()) == []
