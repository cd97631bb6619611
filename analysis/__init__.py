"""Figures of a run: load -> compute -> draw, one figure per file. `python -m analysis run=<folder>` draws
them."""

import camp  # noqa: F401  (first, for what it does where a command begins)
