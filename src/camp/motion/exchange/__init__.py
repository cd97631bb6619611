"""Motions of other projects, read into the clip format."""
