"""The one way to open an ONNX file for inference."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from camp.common.errors import CampError

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

DEFAULT, ERRORS = -1, 3  # onnxruntime's levels of what it logs


def open_session(path: Path, missing: str, log_level: int = DEFAULT) -> InferenceSession:
    """The network of a file, on one thread of the CPU.

    missing: what to say where there is no such file. Raises CampError where the file or onnxruntime is missing, or the
    file is no ONNX.
    """
    try:
        import onnxruntime
    except ImportError as error:
        raise CampError(
            "package onnxruntime: not installed; install camp's extra `export`: "
            "pip install -e '.[export]' -c constraints.txt"
        ) from error
    if not path.is_file():
        raise CampError(f"policy {path}: {missing}")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1  # for so small a network further ones only wait, and burn a processor
    options.log_severity_level = log_level
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has no class of its own for all that a damaged file raises
        raise CampError(f"policy {path}: not a readable ONNX file; export it again") from error
