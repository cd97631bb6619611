"""Evaluation: roll the policy out, read gaits and errors from what the robot did, report."""
