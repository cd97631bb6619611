"""Files and folders on Hydra's command line: written as they are, without quotes of Hydra's own grammar."""

from __future__ import annotations

import re

PLACES = ("resume", "run", "output_dir", "motion.folder", "motion.perturbed_folder")

_NEEDS_QUOTES = re.compile(r"[^A-Za-z0-9_/.+@%-]")


def quoted_place(override: str, sweep: bool) -> str:
    """An override such as ``run=my runs/a (1)`` as Hydra reads it: ``run="my runs/a (1)"``.

    Other overrides, and values that carry quotes already, are left alone; sweep: a comma separates the jobs' values.
    """
    key, equals, value = override.partition("=")
    plain = value.replace(",", "") if sweep else value
    if key.lstrip("+") not in PLACES or not equals or not _NEEDS_QUOTES.search(plain) or value[:1] in "\"'":
        return override
    if sweep and "," in value:
        return f"{key}=" + ",".join(_quoted(part) for part in value.split(","))
    return f"{key}={_quoted(value)}"


def _quoted(value: str) -> str:
    escaped = value.replace("\\", "\\\\") if value.endswith("\\") else value
    return '"' + escaped.replace('"', '\\"') + '"'
