"""`mimics report RUN`: write the report of a run, complete or not, as one HTML file."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.terminal.output import answer, say
from mimics_app.contracts.errors import PartialDataError

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("folder", type=Path, metavar="RUN", help="run folder")


def run(args: argparse.Namespace) -> int:
    """Write RUN/report.html; 0, or 6 when parts of the recording are missing."""
    from mimics_app.recording.run import Run
    from mimics_app.recording.verdict import evaluate

    opened = Run.open(args.folder)
    from mimics_app.recording.report import write_report
    from mimics_app.tasks.kinds.registry import report_sections

    report = write_report(args.folder, report_sections())
    problems = list(evaluate(opened).problems)
    counts = {"status": opened.status, "trials": len(opened.trials), "problems": problems}
    answer(args, {"report": report, **counts}, [str(report)])
    for problem in () if args.json else problems:
        say(f"{args.folder}: {problem}")
    return PartialDataError.exit_code if problems else 0
