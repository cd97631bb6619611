"""A policy to play with in the browser: live controls, the robot, and what its feet do."""
