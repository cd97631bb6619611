"""Reading what others made: whatever a library raises on such a file is the file's fault, told in one line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from camp.common.errors import CampError

LARGEST_BYTES = 2**28  # of a file, and of what it unpacks to: an hour of motion in any format takes less


@contextmanager
def foreign_file(path: Path, what: str, remedy: str, error: type[CampError]) -> Iterator[None]:
    """Turn whatever reading raises into one `error`: "`what` (the reason); `remedy`".

    Lists of exceptions miss some: parsers of damaged files raise RecursionError, OverflowError, MemoryError and their
    own. Keep what stands inside to the reading itself. Files beyond LARGEST_BYTES are refused unread.
    """
    try:
        size = path.stat().st_size
        if size > LARGEST_BYTES:
            raise ValueError(f"{size / 2**20:.0f} MiB, at most {LARGEST_BYTES / 2**20:.0f} are read")
        yield
    except CampError:
        raise
    except Exception as reason:
        text = reason.strerror if isinstance(reason, OSError) and reason.strerror else str(reason)
        line = " ".join((text.splitlines() or [""])[0].split()) or type(reason).__name__
        raise error(f"{what} ({line}); {remedy}") from reason
