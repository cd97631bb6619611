"""The observation page in the docs is the code's."""

from __future__ import annotations

import pytest

from analysis.observations import document
from camp.common.paths import repository_root


def test_the_page_is_up_to_date():
    root = repository_root()
    if root is None:
        pytest.skip("installed from a wheel, which holds no docs")
    page = (root / "docs" / "observations.md").read_text()
    assert page == document(), "run: python -m analysis.observations > docs/observations.md"
