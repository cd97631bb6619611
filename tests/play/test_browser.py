"""The page in a real browser, headless Chromium: web/check/play.js tries it."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

from camp.common.paths import repository_root
from tests.play.started import started

WEB = repository_root() / "web"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.mark.slow
def test_buttons_keys_push_pause_and_reset_do_what_they_say(tmp_path):
    pytest.importorskip("mjviser", reason="comes with the play extra")
    if shutil.which("node") is None or not (WEB / "node_modules" / ".package-lock.json").is_file():
        pytest.skip("node or npm's packages are not there; `make web` installs the packages")
    if not any(map(shutil.which, (os.environ.get("CHROMIUM", ""), *BROWSERS))):
        pytest.skip("no browser: install chromium or set CHROMIUM=<path>")
    with started() as (_, address):
        script = ["node", str(WEB / "check" / "play.js"), address, str(tmp_path)]
        done = subprocess.run(script, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("the page works\n")
    assert (tmp_path / "play.png").stat().st_size > 20_000
