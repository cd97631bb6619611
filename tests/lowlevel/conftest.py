from __future__ import annotations

from pathlib import Path

import pytest

from camp.common.paths import policies_root
from camp.deployment.loop import Policy


@pytest.fixture(scope="session")
def shipped_path(tmp_path_factory) -> Path:
    """The shipped policy's policy.onnx."""
    pytest.importorskip("onnx", reason="comes with the export extra")
    pytest.importorskip("onnxruntime", reason="comes with the export extra")
    from camp.deployment.export import export_policy

    return export_policy(policies_root() / "go2_camp", tmp_path_factory.mktemp("shipped")).model


@pytest.fixture(scope="session")
def shipped(shipped_path) -> Policy:
    """The shipped policy."""
    return Policy(shipped_path)
