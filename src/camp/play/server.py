"""viser's server: the page, the buttons and the picture in it."""

from __future__ import annotations

import contextlib
import io
import socket
from collections.abc import Iterator
from typing import TYPE_CHECKING

from camp.common.errors import CampError, ConfigError

if TYPE_CHECKING:
    from viser import ViserServer


def require_viser() -> None:
    """Raises CampError where viser or mjviser is not installed."""
    try:
        import mjviser  # noqa: F401
        import viser  # noqa: F401
    except ImportError as error:
        raise CampError(
            f"package {error.name}: not installed; install camp's extra `play`: "
            "pip install -e '.[play]' -c constraints.txt"
        ) from error


@contextlib.contextmanager
def served(host: str, port: int) -> Iterator[ViserServer]:
    """A server until the end of the block. port 0: any free one.

    Raises ConfigError where the port is taken (viser would silently serve at the next one), or cannot be had.
    """
    import viser

    _check_free(host, port)
    with contextlib.redirect_stdout(io.StringIO()):  # it prints addresses of its own
        server = viser.ViserServer(host=host, port=port, label="camp", verbose=False)
    try:
        if port not in (0, server.get_port()):
            raise _taken(port, "in use")
        server.gui.configure_theme(control_width="medium", show_logo=False, show_share_button=False)
        yield server
    finally:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()


def _check_free(host: str, port: int) -> None:
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as the server does, right after another's end
        try:
            trial.bind((host, port))
        except OSError as error:
            if isinstance(error, socket.gaierror):
                raise ConfigError(f"host = {host}: {error.strerror}; give an address of this machine") from error
            raise _taken(port, error.strerror or str(error)) from error


def _taken(port: int, reason: str) -> ConfigError:
    return ConfigError(f"port = {port}: {reason}; give another one, or 0 for any that is free")
