"""The command in a process of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from camp.common.paths import policies_root

SHIPPED = policies_root() / "go2_camp"


@contextmanager
def started() -> Iterator[tuple[subprocess.Popen[str], str]]:
    """`python -m camp.play` with the shipped policy at a free port, and its address; ended with the block."""
    arguments = [sys.executable, "-m", "camp.play", f"run={SHIPPED}", "port=0"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(arguments, env=os.environ | {"OMP_NUM_THREADS": "1"}, **pipes)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.match(r"(http://localhost:\d+) in your browser; Ctrl-C ends it$", line)
        if found is None:
            pytest.fail(line + process.communicate()[1])
        yield process, found[1]
    finally:
        process.kill()
        process.wait()
