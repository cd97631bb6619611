"""Hydra's and OmegaConf's errors as one line: the thing, its value and the remedy."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath
from typing import Any

from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import (
    ConfigAttributeError,
    ConfigKeyError,
    InterpolationResolutionError,
    MissingMandatoryValue,
    OmegaConfBaseException,
    ValidationError,
)

from camp.common.errors import CampError
from camp.common.paths import ablation_root

#: The errors that are the input's or the machine's fault; every other exception is a bug and keeps its traceback.
INPUT_ERRORS = (CampError, HydraException, OmegaConfBaseException, OSError)

#: What conf/hydra/launcher builds on, and where it comes from.
LAUNCHER_PACKAGES = {
    "hydra/launcher/joblib": "hydra-joblib-launcher",
    "hydra/launcher/submitit_slurm": "hydra-submitit-launcher",
}


def describe(error: BaseException) -> str:
    """The line to print for one of INPUT_ERRORS."""
    return " ".join(_describe(error).split())


def diagnosis(error: BaseException) -> str:
    """As `describe`, for values that stand in a file: without the remedies that only help on the command line."""
    line = describe(error)
    return line if isinstance(error, CampError) else line.rpartition("; ")[0] or line


def _describe(error: BaseException) -> str:
    if isinstance(error, CampError):
        return str(error)
    if isinstance(error, MissingConfigException):
        return _missing_config(error)
    if isinstance(error, OverrideParseException):
        lines = error.message.splitlines()
        reason = [line for line in lines if not line.startswith(("Error parsing", "See http"))]
        return (
            f"override {error.override!r}: not understood ({'; '.join(reason)}); write key=value, "
            "with quotes around a value that holds special characters: 'key=\"a=b\"'"
        )
    if isinstance(error, OmegaConfBaseException):
        return _omegaconf(error)
    if isinstance(error, OSError) and not isinstance(error, HydraException):
        place = f"{error.filename}: " if error.filename is not None else ""
        return f"{place}{error.strerror or error}; check the path, its rights and the space on the disk"
    return _composition(error)


def _missing_config(error: MissingConfigException) -> str:
    wanted = PurePosixPath(error.missing_cfg_file or "")
    if package := LAUNCHER_PACKAGES.get(str(wanted)):
        return f"{wanted.parent} {wanted.name!r}: {package} is not installed; install it with pip install 'camp[sweep]'"
    if not error.options:
        return f"config {str(wanted)!r}: not found; check it, or leave --config-name and --config-path out"
    guess = _guess(wanted.name, error.options)
    remedy = f"choose one of {', '.join(error.options)}"
    return f"{wanted.parent} {wanted.name!r}: no such option; {f'{guess} Or {remedy}' if guess else remedy}"


def _composition(error: BaseException) -> str:
    """Errors that tell Hydra's own part only in their text (checked against 1.3.8 by the tests)."""
    text = str(error)
    cause = error.__cause__ if error.__cause__ is not None else error.__context__
    if isinstance(cause, OmegaConfBaseException):
        file = re.match(r"In '(.+?)':", text)
        return f"{f'config {file[1]}: ' if file else ''}{_omegaconf(cause)}"
    if found := re.match(r"Could not override '(.+)'\. No match in the defaults list\.\n.*use (\S+)", text):
        return f"override {found[1]!r}: not in the defaults list, so it must be appended; write {found[2]}"
    if found := re.match(r"Could not append to config\. An item is already at '(.+)'", text):
        return f"override +{found[1]}: the key exists already; leave the + out"
    if found := re.match(r"Ambiguous value for argument '(.+)'", text):
        key, _, value = found[1].partition("=")
        return f"override {found[1]!r}: a list or a sweep? Write {key}=[{value}], or add -m for a sweep"
    if found := re.match(r"Could not delete from config\. '(.+)' does not exist", text):
        return f"override ~{found[1]}: no such key; leave it out"
    return f"config: {'; '.join(line.strip() for line in text.splitlines() if line.strip())}"


def _omegaconf(error: OmegaConfBaseException) -> str:
    key = error.full_key or "config"
    reason = (error.msg or str(error)).splitlines()[0]
    if isinstance(error, (ConfigKeyError, ConfigAttributeError)):
        return f"{key}: unknown key; {_close_keys(error) or 'check its spelling, see --cfg job for all keys'}"
    if isinstance(error, MissingMandatoryValue):
        return f"{key}: has no value; set it with {key}=<value>"
    if isinstance(error, InterpolationResolutionError):
        return f"{key}: refers to what is not there ({reason}); correct the ${{...}} in its value"
    if isinstance(error, ValidationError):
        return f"{key} {_value(error)}: wrong type ({reason}); {_type_remedy(error)}"
    return f"{key}: {reason}; correct its value"


def _value(error: OmegaConfBaseException) -> str:
    return repr(OmegaConf.to_container(error.value) if OmegaConf.is_config(error.value) else error.value)


def _type_remedy(error: OmegaConfBaseException) -> str:
    value = error.value
    if "Integer" in (error.msg or "") and isinstance(value, float) and value.is_integer():
        return f"write {int(value)}"
    current = _current_value(error)
    return f"write a value like {current!r}" if current is not None else "see --cfg job for values that fit"


def _current_value(error: OmegaConfBaseException) -> Any:
    if not isinstance(error.parent_node, DictConfig) or error.key is None:
        return None
    node = error.parent_node._get_node(error.key, validate_access=False)
    value = node._value() if node is not None else None  # type: ignore[union-attr]
    return value if isinstance(value, (bool, int, float, str)) and value != "???" else None


def _close_keys(error: OmegaConfBaseException) -> str:
    """Keys like the unknown one: spelt alike, or of the same name in another place."""
    root = error.parent_node._get_root() if error.parent_node is not None else None
    if not isinstance(root, DictConfig):
        return ""
    paths = list(_paths(root))
    wanted = str(error.full_key)
    if not wanted.startswith("hydra"):
        paths = [path for path in paths if path.split(".")[0] != "hydra"]
    leaf = wanted.rsplit(".", 1)[-1]
    same_name = [path for path in paths if path.rsplit(".", 1)[-1] == leaf]
    groups = {f"+{file.parent.name}" for file in ablation_root().glob("*/*.yaml")}
    return _guess(wanted, [*same_name, *paths, *sorted(groups)], len(same_name))


def _paths(config: DictConfig, prefix: str = "") -> Iterator[str]:
    for key in config:
        yield f"{prefix}{key}"
        node = config._get_node(key, validate_access=False)
        if isinstance(node, DictConfig) and isinstance(node._value(), dict):
            yield from _paths(node, f"{prefix}{key}.")


def _guess(wanted: str, known: Sequence[str], certain: int = 0) -> str:
    """A question naming up to three of `known`: the first `certain` ones and those spelt like `wanted`."""
    close = [*known[:certain], *difflib.get_close_matches(wanted, known, n=3, cutoff=0.75)]
    return f"did you mean {' or '.join(list(dict.fromkeys(close))[:3])}?" if close else ""
