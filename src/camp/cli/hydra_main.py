"""What every command line of camp shares: Hydra's configuration, one-line errors, run folders."""

from __future__ import annotations

import contextlib
import difflib
import os
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

import hydra
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra._internal.utils import get_args_parser
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.types import RunMode
from omegaconf import DictConfig

from camp.cli.places import quoted_place
from camp.common import distributed
from camp.common.errors import ConfigError, LauncherError
from camp.common.paths import config_root
from camp.config.compose import register_ablations
from camp.config.hydra_errors import INPUT_ERRORS, describe
from camp.config.renamed import renamed_overrides

EXIT_BUG = 1
EXIT_INPUT = 2
EXIT_INTERRUPTED = 130  # what a shell reports for Ctrl-C

# Hydra's options, by whether a value follows as the next argument.
_FLAGS = ("--multirun", "-m", "--run", "-r", "--help", "-h", "--hydra-help", "--version", "--resolve")
_FLAGS_WITH_VALUE = (
    *("--cfg", "-c", "--package", "-p", "--info", "-i", "--config-path", "-cp", "--config-name", "-cn"),
    *("--config-dir", "-cd"),
)


def run_hydra(
    config_name: str,
    task: Callable[[DictConfig], Any],
    argv: Sequence[str] | None = None,
    after_sweep: Callable[[list[Path]], None] = lambda folders: None,
) -> int:
    """Compose `conf/<config_name>.yaml` with the overrides in `argv` (default: the command line), run `task`.

    Groups are the folders beside that file.

    Returns the exit code: 0; EXIT_INPUT after an error of the input, told in one line on stderr; EXIT_BUG
    after a job of a sweep ended in a bug, its traceback on stderr; EXIT_INTERRUPTED after Ctrl-C. Outside a
    sweep a bug propagates. A sweep goes on after a failed job; Ctrl-C ends it, provided that `task` lets
    KeyboardInterrupt through. At its end `after_sweep` gets the folders that its jobs returned. CAMP_DEBUG=1 shows the
    traceback of input errors too.
    """
    primary = config_root() / config_name
    register_ablations()
    try:
        arguments = _overrides_first(sys.argv[1:] if argv is None else argv)
        _check_options(arguments)
        sweep = {"-m", "--multirun"} & set(arguments)
        place = tempfile.TemporaryDirectory() if sweep else contextlib.nullcontext()
        with place as notes, _command_line(arguments), _launcher_errors(arguments):
            job = _Job(task, number_of_jobs(arguments), notes)
            hydra.main(config_path=str(primary.parent), config_name=primary.name, version_base="1.3")(job)()
            if folders := job.folders():
                after_sweep(folders)
        if job.error is not None:
            raise job.error
        return EXIT_BUG if EXIT_BUG in job.exit_codes else max(job.exit_codes, default=0)
    except INPUT_ERRORS as error:
        return report(error)
    except _JobFailedElsewhereError as failure:
        return failure.exit_code
    except KeyboardInterrupt:
        print(f"{distributed.label()}interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except SystemExit as leave:  # --help, --version
        return leave.code if isinstance(leave.code, int) else int(leave.code is not None)


class _JobFailedElsewhereError(Exception):
    """A job that a launcher ran in another process failed; its error has been printed there."""

    def __init__(self, exit_code: int) -> None:
        super().__init__(exit_code)
        self.exit_code = exit_code


class _Job:
    """The task as Hydra calls it: once, or once for each job of a sweep."""

    def __init__(self, task: Callable[[DictConfig], Any], number: int, notes: str | None) -> None:
        """number: of the jobs; notes: the folder in which those of a sweep, in any process, leave what they return."""
        self.task, self.number, self.notes = task, number, None if notes is None else Path(notes)
        self.process = os.getpid()
        self.error: Exception | None = None  # of a single run
        self.exit_codes: list[int] = []  # of a sweep's failed jobs

    def __call__(self, config: DictConfig) -> Any:
        """Run the task. Its errors bypass Hydra, which would wrap them in lines of its own."""
        hydra_config = HydraConfig.get()
        if hydra_config.mode != RunMode.MULTIRUN:
            return self._run(config)
        index, values = hydra_config.job.num, " ".join(hydra_config.overrides.task)
        print(f"job {index + 1} of {self.number}: {values}", flush=True)
        result = self._run(config)
        if isinstance(result, Path) and self.notes is not None:
            with contextlib.suppress(OSError):  # on another machine the folder is not there
                (self.notes / f"{index:06d}").write_text(str(result), encoding="utf-8")
        return result

    def folders(self) -> list[Path]:
        """What the jobs of a sweep returned, in their order."""
        notes = [] if self.notes is None else sorted(self.notes.iterdir())
        return [Path(note.read_text(encoding="utf-8")) for note in notes]

    def _run(self, config: DictConfig) -> Any:
        try:
            return self.task(config)
        except Exception as error:
            if HydraConfig.get().mode != RunMode.MULTIRUN:
                self.error = error
                return None
            exit_code = report(error, f"job {HydraConfig.get().job.num}: ")
            if os.getpid() != self.process:
                raise _JobFailedElsewhereError(exit_code) from None
            self.exit_codes.append(exit_code)
            return None


def number_of_jobs(arguments: Sequence[str]) -> int:
    """How many jobs a command line asks for; 1 where it cannot be told, which is then an error of Hydra's."""
    if not {"-m", "--multirun"} & set(arguments):
        return 1
    overrides = [argument for argument in arguments if not argument.startswith("-")]
    try:
        parsed = OverridesParser.create().parse_overrides(overrides)
        return sum(map(len, BasicSweeper.split_arguments(parsed, None)))
    except HydraException:
        return 1


def report(error: Exception, prefix: str = "") -> int:
    """Print an error of the input as one line, anything else as a bug; return the exit code."""
    bug = not isinstance(error, INPUT_ERRORS)
    if bug or os.environ.get("CAMP_DEBUG") == "1":
        traceback.print_exception(error)
    if not bug:
        print(f"error: {distributed.label()}{prefix}{describe(error)}", file=sys.stderr, flush=True)
    return EXIT_BUG if bug else EXIT_INPUT


def _overrides_first(argv: Sequence[str]) -> list[str]:
    """The arguments with all options behind the overrides, since Hydra's parser takes no override after one.

    Raises ConfigError for an option that does not exist, such as an override written with dashes.
    """
    overrides: list[str] = []
    options: list[str] = []
    arguments = iter(argv)
    for argument in arguments:
        name, equals, _ = argument.partition("=")
        if not argument.startswith("-"):
            overrides.append(argument)
        elif name not in _FLAGS + _FLAGS_WITH_VALUE:
            raise ConfigError(_unknown_option(argument))
        elif equals and name in _FLAGS:
            raise ConfigError(f"option {argument}: takes no value; overrides have no dashes: {argument.lstrip('-')}")
        else:
            options.append(argument)
            if name in _FLAGS_WITH_VALUE and not equals:
                options.extend(value for value in [next(arguments, None)] if value is not None)
    for name in _FLAGS_WITH_VALUE:
        if options and options[-1] == name:
            raise ConfigError(f"option {name}: has no value; write {name} <value>, see --hydra-help")
    sweep = bool({"-m", "--multirun"} & set(options))
    return [quoted_place(override, sweep) for override in renamed_overrides(overrides)] + options


def _check_options(arguments: Sequence[str]) -> None:
    """Raise ConfigError for options that Hydra's parser refuses, which would print its usage and leave."""

    def refuse(message: str) -> NoReturn:
        raise ConfigError(f"command line: {message}; see --hydra-help")

    parser = get_args_parser()
    parser.error = refuse
    parser.parse_args(arguments)


@contextlib.contextmanager
def _launcher_errors(arguments: Sequence[str]) -> Iterator[None]:
    """Turn what a sweep's launcher raises into one line; its jobs' own errors have been dealt with by `_Job`."""
    try:
        yield
    except (*INPUT_ERRORS, _JobFailedElsewhereError):
        raise
    except Exception as error:
        if not {"-m", "--multirun"} & set(arguments):
            raise
        chosen = next((a for a in arguments if a.startswith("hydra/launcher=")), "hydra/launcher=basic")
        reason = " ".join(str(error).split()) or type(error).__name__
        raise LauncherError(
            f"{chosen}: the launcher ended the sweep ({reason}); check hydra.launcher.* (--cfg hydra -p hydra.launcher "
            "prints it), or leave it out to run the jobs one after the other"
        ) from error


def _unknown_option(argument: str) -> str:
    name, equals, _ = argument.partition("=")
    if equals:
        return f"option {argument}: no such option; overrides have no dashes: {argument.lstrip('-')}"
    close = difflib.get_close_matches(name, _FLAGS + _FLAGS_WITH_VALUE, n=1)
    return f"option {argument}: no such option; {f'did you mean {close[0]}?' if close else 'see --help'}"


@contextlib.contextmanager
def _command_line(arguments: Sequence[str]) -> Iterator[None]:
    """Let hydra.main see these arguments, and raise its errors instead of printing them and leaving."""
    argv, full_error = sys.argv, os.environ.get("HYDRA_FULL_ERROR")
    sys.argv = [argv[0], *arguments]
    os.environ["HYDRA_FULL_ERROR"] = "1"
    try:
        yield
    finally:
        sys.argv = argv
        if full_error is None:
            del os.environ["HYDRA_FULL_ERROR"]
        else:
            os.environ["HYDRA_FULL_ERROR"] = full_error
