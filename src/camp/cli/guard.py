"""The one way in which a command ends: its exit code, errors of the input in one line, Ctrl-C without a traceback."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from camp.cli.hydra_main import EXIT_INTERRUPTED, report
from camp.config.hydra_errors import INPUT_ERRORS


def guarded(task: Callable[[], int]) -> int:
    """Run `task`, which returns an exit code; returns that, or the one of how it failed.

    Errors of the input, and files that the system cannot read or write, are one line on stderr; CAMP_DEBUG=1 shows the
    traceback, too. Where nobody reads the output any more (`| head`), it ends silently.
    """
    try:
        code = task()
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python complains when it ends
        return 0
    except INPUT_ERRORS as error:
        return report(error)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
