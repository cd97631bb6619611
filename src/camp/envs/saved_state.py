"""States of the environment that earlier versions saved, as they are saved today."""

from __future__ import annotations

from typing import Any


def upgraded(state: dict[str, Any]) -> dict[str, Any]:
    """The state with all that has been added since: see the comments for what each version lacked."""
    state = {
        "num_steps": 0,  # before env.episode_growth nobody counted
        "difficulty": 1.0,  # before env.hardening there was none
        "skill_schedule": None,
    } | state
    if "amp_state" not in state:
        return state
    # Before env.transition_ages each robot's last AMP state alone was kept, and starts_observed was starts_sight.
    observed: dict[str, Any] = dict(state["starts_observed" if "starts_observed" in state else "starts_sight"])
    starts = state["starts"] | {"amp_history": observed.pop("amp_state")[:, None]}
    return state | {"amp_history": state["amp_state"][:, None], "starts": starts, "starts_observed": observed}
