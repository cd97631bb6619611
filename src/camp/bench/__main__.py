"""Measure speed: ``python -m camp.bench [overrides]``."""

import sys

from camp.bench.measure import bench
from camp.cli.hydra_main import run_hydra

if __name__ == "__main__":
    sys.exit(run_hydra("train", bench))
