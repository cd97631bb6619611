"""Atomic writing of files: complete or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from camp.common.errors import ConfigError

PARTIAL = ".partial"  # how the name of a file ends that is still being written


@contextmanager
def whole_file(path: Path, check: Callable[[Path], object] | None = None) -> Iterator[BinaryIO]:
    """A file to write to, which takes its name, and the place of what is there, once all of it is on the disk.

    check: reads the finished file back before it takes its name; where it raises, what is there stays.
    Makes the folder. A process killed on the way leaves a ``*.partial`` behind. Raises OSError.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.{os.getpid()}{PARTIAL}")
    try:
        with partial.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if check is not None:
            check(partial)
        partial.replace(path)
        _sync_folder(path.parent)
    finally:
        partial.unlink(missing_ok=True)


def write_text(path: Path, text: str, check: Callable[[Path], object] | None = None) -> None:
    """Write a text file whole; `check` as in `whole_file`. Raises ConfigError where the folder cannot be written."""
    try:
        with whole_file(path, check) as file:
            file.write(text.encode())
    except OSError as error:
        raise ConfigError(f"file {path}: {error.strerror or error}; choose a folder that can be written") from error


def make_folder(path: Path) -> Path:
    """Make a folder for output, if it is not there, and return it. Raises ConfigError where it cannot be written."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        raise ConfigError(
            f"output folder {path}: {error.strerror or error}; make it a folder that can be written"
        ) from error


@contextmanager
def folder_lock(folder: Path, wait: bool = True) -> Iterator[None]:
    """Let other processes that come here wait, where the system has file locks; makes the folder.

    The lock is the folder's own: nothing is written, and it ends with the process. Says once that it waits. Raises
    ConfigError where the folder cannot be made, or, without `wait`, where another process has it.
    """
    make_folder(folder)
    handle = os.open(folder, os.O_RDONLY)
    try:
        with contextlib.suppress(ImportError, OSError):
            import fcntl

            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                if not wait:
                    raise ConfigError(
                        f"folder {folder}: another process is writing to it; wait for it, or stop it"
                    ) from error
                print(f"waiting for another process that writes to {folder}", flush=True)
                fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _sync_folder(folder: Path) -> None:
    """Make the renaming itself survive a power cut."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
