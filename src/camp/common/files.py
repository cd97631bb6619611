"""Atomic writing of files: complete or not at all."""

from __future__ import annotations

import contextlib
import glob
import os
import socket
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
    Makes the folder. A process killed on the way leaves a ``*.partial`` behind, which the next one to write this file
    removes. Raises OSError.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    machine = socket.gethostname()
    for left in path.parent.glob(f"{glob.escape(path.name)}.{glob.escape(machine)}.*{PARTIAL}"):
        if not _is_running(left.name.removesuffix(PARTIAL).rpartition(".")[2]):
            left.unlink(missing_ok=True)
    partial = path.with_name(f"{path.name}.{machine}.{os.getpid()}{PARTIAL}")
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


@contextmanager
def whole_pair(first: Path, second: Path) -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """Two files to write to that belong together: the second, where it is there, stands beside its own first.

    Otherwise as `whole_file`; where one of them cannot be written, both stay as they were.
    """
    with whole_file(second) as last:

        def make_room(_: Path) -> None:
            last.flush()
            os.fsync(last.fileno())  # a full disk shows itself now at the latest
            second.unlink(missing_ok=True)

        with whole_file(first, make_room) as head:
            yield head, last


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


def _is_running(process: str) -> bool:
    """Whether there is a process of this number on this machine."""
    try:
        os.kill(int(process), 0)
    except (ValueError, OverflowError, ProcessLookupError):
        return False
    except PermissionError:  # another user's
        return True
    return True


def _sync_folder(folder: Path) -> None:
    """Make the renaming itself survive a power cut."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
