"""Errors a user can act on: one line that names the thing, the value and the remedy."""


class CampError(Exception):
    """Base of every error that is the input's fault; command lines print it without a traceback."""


class ConfigError(CampError):
    """A configuration key holds a value that cannot work."""


class SimulationError(CampError):
    """The simulator met a situation that it cannot simulate as modelled."""


class ClipError(CampError):
    """An expert motion clip is missing, unreadable or wrong."""


class RankError(CampError):
    """A process of data-parallel training lost the others."""


class LauncherError(CampError):
    """A launcher could not start the jobs of a sweep, or lost one."""


class CheckpointError(CampError):
    """A checkpoint is missing, unreadable or does not fit the run."""
