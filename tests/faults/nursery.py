"""Commands as processes of their own that can be killed, without the seconds that each would spend on imports.

Run as a script it imports once what every command needs. Then it forks a child for each request: a line of
JSON on stdin, answered by one on stdout. A child runs `python -m <module> <arguments>` as the shell would.
"""

from __future__ import annotations

import json
import os
import runpy
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


class Nursery:
    """The process that forks, as a context manager."""

    def __enter__(self) -> Nursery:
        quiet = {"CUDA_VISIBLE_DEVICES": "", "OMP_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1"}
        path = os.pathsep.join([str(ROOT / "src"), str(ROOT)])  # spawned processes import from here, too
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=os.environ | quiet | {"PYTHONPATH": path},
        )
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()

    def start(self, command: Sequence[str], folder: Path, name: str, **environment: str | None) -> Job:
        """Run `python -m command` in ``folder``; its output goes to ``<folder>/<name>.log``.

        environment: variables for it alone; None takes one away.
        """
        log = folder / f"{name}.log"
        pid = self.ask(command=list(command), folder=str(folder), log=str(log), environment=environment)
        return Job(self, pid, log)

    def ask(self, **request: Any) -> Any:
        """One answer to one request."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())


@dataclass
class Job:
    """One running command."""

    nursery: Nursery
    pid: int
    log: Path
    code: int | None = None  # how it ended: the exit code, or minus the signal

    @property
    def output(self) -> str:
        """All that it has printed."""
        return self.log.read_text(encoding="utf-8") if self.log.exists() else ""

    def ended(self) -> bool:
        """Whether it has."""
        if self.code is None:
            self.code = self.nursery.ask(ended=self.pid)
        return self.code is not None

    def wait(self) -> int:
        """Its exit code, or minus the signal."""
        if self.code is None:
            self.code = self.nursery.ask(wait=self.pid)
        assert self.code is not None
        return self.code

    def kill(self) -> None:
        """SIGKILL, to this process alone."""
        if not self.ended():
            os.kill(self.pid, signal.SIGKILL)
            self.wait()


def serve() -> None:
    """Answer requests until stdin ends."""
    import torch._dynamo  # noqa: F401  (what torch's optimizers import when the first is made)

    import camp.deployment.package
    import camp.evaluation.films
    import camp.evaluation.output
    import camp.evaluation.record
    import camp.training.session  # noqa: F401

    for line in sys.stdin:
        request = json.loads(line)
        if "command" in request:
            answer = os.fork() or _become(request)
        else:
            pid = request.get("wait") or request["ended"]
            done, status = os.waitpid(pid, 0 if "wait" in request else os.WNOHANG)
            answer = os.waitstatus_to_exitcode(status) if done else None
        print(json.dumps(answer), flush=True)


def _become(request: dict[str, Any]) -> int:
    """Turn this forked process into the command; never returns."""
    os.setsid()
    log = os.open(request["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for target, source in ((0, nothing), (1, log), (2, log)):
        os.dup2(source, target)
    os.chdir(request["folder"])
    for name, value in request["environment"].items():
        os.environ.pop(name, None)
        if value is not None:
            os.environ[name] = value
    module, *arguments = request["command"]
    sys.argv = [module, *arguments]
    code: Any = 1
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as leave:
        code = leave.code
    except BaseException:
        import traceback

        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 0)


if __name__ == "__main__":
    serve()
