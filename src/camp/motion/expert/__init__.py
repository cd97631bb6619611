"""The model-based expert: reference, MPC, whole-body control, behind the learner's interface."""
