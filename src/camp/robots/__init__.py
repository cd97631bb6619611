"""The robot: model file, physical constants and leg kinematics."""
