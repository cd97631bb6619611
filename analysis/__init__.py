"""Figures of a run: load -> compute -> draw, one figure per file. `python -m analysis run=<folder>` draws
them."""
