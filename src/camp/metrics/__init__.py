"""Measurements of motion in plain numpy: gait from foot contacts, tracking from states."""
