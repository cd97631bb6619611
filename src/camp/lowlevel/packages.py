"""The packages of the extra `go2`."""

from __future__ import annotations

from camp.common.errors import CampError


def require_dds() -> None:
    """Raises CampError where cyclonedds or Unitree's SDK is not installed."""
    try:
        import cyclonedds  # noqa: F401
        import unitree_sdk2py  # noqa: F401
    except ImportError as error:
        raise CampError(
            f"package {error.name}: not installed; install camp's extra `go2`: "
            "pip install -e '.[go2]' -c constraints.txt"
        ) from error
