"""One policy in several physics engines: the same robot, the same loop, the same judge (docs/transfer.md)."""
