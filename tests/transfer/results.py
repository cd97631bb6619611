"""Results that nobody walked."""

from __future__ import annotations

from camp.evaluation.report import SuiteStamp
from camp.transfer.results import Judged, Result

STAMP = SuiteStamp("short", "a", "b", "c", 0)
RIGHT = Judged("trot_2hz", [0.6, 0.0, 0.0], None, "trot", 2.1, [0.6, 0.1, 0.02], [])
FAST = Judged("pace_2hz", [0.3, 0.0, 0.0], None, "pace", 2.4, [0.3, 0.0, 0.0], ["frequency"])
FELL = Judged("pace_2hz", [0.6, 0.0, 0.0], 1.5)


def result(engine: str, *walks: Judged, **changes) -> Result:
    """Of the Go2, by default."""
    values = {"robot": "go2", "policy": "mine", "network": "d", "suite": STAMP, "version": "1.2", "timestep_s": 0.001}
    return Result(format=1, kind="transfer", engine=engine, walks=list(walks), **(values | changes))
