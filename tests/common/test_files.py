"""A file is there whole or not at all."""

from __future__ import annotations

import pytest

from camp.common.errors import ConfigError
from camp.common.files import make_folder, whole_file, write_text


def test_what_was_there_stays_until_the_new_file_is_complete(tmp_path):
    path = tmp_path / "report.json"
    path.write_text("old")
    with pytest.raises(RuntimeError), whole_file(path) as file:
        file.write(b"half of the n")
        file.flush()
        assert path.read_text() == "old"
        raise RuntimeError("stopped on the way")
    assert path.read_text() == "old"
    assert [one.name for one in tmp_path.iterdir()] == ["report.json"]
    with whole_file(path) as file:
        file.write(b"new")
    assert path.read_text() == "new"


def test_the_folder_is_made(tmp_path):
    write_text(tmp_path / "a" / "b" / "note.txt", "tilde: ~, umlaut: \u00fc")
    assert (tmp_path / "a" / "b" / "note.txt").read_text(encoding="utf-8") == "tilde: ~, umlaut: \u00fc"


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match=r"file .*note\.txt: .*choose a folder that can be written"):
        write_text(tmp_path / "file" / "note.txt", "text")


def test_an_output_folder_is_made_or_named(tmp_path):
    assert make_folder(tmp_path / "a" / "b").is_dir() and list((tmp_path / "a" / "b").iterdir()) == []
    make_folder(tmp_path / "a")
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(ConfigError, match=rf"output folder {path}: .*make it a folder that can be written"):
            make_folder(path)
