"""The run folder: the names of its files, checkpoints, metrics, versions and the W&B run."""
