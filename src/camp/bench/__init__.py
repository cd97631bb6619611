"""Speed of simulation, environment and training: ``python -m camp.bench``."""
