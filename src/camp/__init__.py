"""camp: multi-skill legged locomotion with conditional adversarial motion priors."""

import ctypes.util
import os
import sys
from types import TracebackType

# OpenMP workers that spin while they wait starve the simulator's threads (a fivefold slow-down on two
# cores); the policy is read when the OpenMP library loads, hence before anything imports torch.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

# MuJoCo chooses its renderer when it is imported, and its default needs a display.
if sys.platform == "linux" and not os.environ.get("DISPLAY") and ctypes.util.find_library("EGL"):
    os.environ.setdefault("MUJOCO_GL", "egl")


def _tell(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Ctrl-C while a command still imports what it needs: one line, as later."""
    if issubclass(kind, KeyboardInterrupt):
        print("interrupted", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


if sys.argv[:1] == ["-m"]:  # so it stands while `python -m camp.<command>` imports this package, and at no other time
    sys.excepthook = _tell

__version__ = "0.1.0"
