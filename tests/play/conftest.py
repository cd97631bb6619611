"""The shipped policy, exported once, and a session with it."""

from __future__ import annotations

import pytest

from camp.common.paths import policies_root
from camp.deployment.loop import Policy
from camp.play.session import Session

PUSH_M_S = 0.5


@pytest.fixture(scope="package")
def shipped(tmp_path_factory) -> Policy:
    """The shipped policy."""
    pytest.importorskip("onnx", reason="comes with the export extra")
    pytest.importorskip("onnxruntime", reason="comes with the export extra")
    from camp.deployment.export import export_policy

    return Policy(export_policy(policies_root() / "go2_camp", tmp_path_factory.mktemp("shipped")).model)


@pytest.fixture
def session(shipped) -> Session:
    """A robot that stands."""
    return Session(shipped, PUSH_M_S)
