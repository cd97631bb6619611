"""What long work says: sparse lines in a file, one rewritten line on a terminal."""

from __future__ import annotations

import io

from camp.common.progress import LINES, phase, track


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_file_gets_sparse_lines_the_first_at_once():
    out = io.StringIO()
    assert list(track(range(1000), "walking", stream=out)) == list(range(1000))
    lines = out.getvalue().splitlines()
    assert lines[0] == "walking: 0 of 1000" and lines[-1] == "walking: 1000 of 1000" and len(lines) == LINES + 1


def test_work_without_parts_says_what_it_is():
    out = io.StringIO()
    with phase("t-SNE of 1600 transitions", stream=out):
        assert out.getvalue() == "t-SNE of 1600 transitions\n"
    assert out.getvalue().count("\n") == 1


def test_fewer_parts_than_lines():
    out = io.StringIO()
    list(track(iter("ab"), "clips", total=2, stream=out))
    assert out.getvalue().splitlines() == ["clips: 0 of 2", "clips: 1 of 2", "clips: 2 of 2"]


def test_a_terminal_gets_one_line_that_goes_away(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    out = Terminal()
    list(track("abc", "walking", stream=out))
    assert "walking" in out.getvalue() and "3 of 3" in out.getvalue()
    assert out.getvalue().count("\n") == 1 and out.getvalue().endswith("\x1b[2K")  # which is then erased
