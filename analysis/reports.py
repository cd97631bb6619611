"""An evaluation's report, eval.json, of a run folder."""

from __future__ import annotations

from pathlib import Path

from analysis.load import AnalysisError, evaluation_folder
from camp.common.commands import command
from camp.evaluation.report import Report, ReportError
from camp.evaluation.report import read_report as read_file
from camp.runs.folder import REPORT


def read_report(run: Path) -> Report:
    """The evaluation of a run folder. Raises AnalysisError where it is missing, damaged or by an older judge."""
    try:
        return read_file(evaluation_folder(run) / REPORT, f"run `{command('camp.evaluate', run=run)}` first")
    except ReportError as error:
        raise AnalysisError(str(error)) from error
