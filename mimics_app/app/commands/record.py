"""`mimics record info|recover|verify|export RUN`: show, repair, verify or export a run folder."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.terminal.output import answer
from mimics_app.contracts.clock import TICKS_PER_SECOND
from mimics_app.contracts.errors import PartialDataError, counted

if TYPE_CHECKING:
    from mimics_app.recording.run import Run
    from mimics_app.recording.verdict import Verdict

__all__ = ["add_arguments", "run"]

_HELP = (
    "info: show the contents; recover: repair and close a run that was cut off; "
    "verify: check it against its checksums; export: write it in another format"
)

_TO = "with export: bids, csv, edf, hdf5, mat, mcap, nwb, parquet, xdf, or an installed exporter"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("action", choices=("info", "recover", "verify", "export"), help=_HELP)
    parser.add_argument("folder", type=Path, metavar="RUN", help="run folder")
    parser.add_argument("--to", default="csv", metavar="NAME", help=_TO)
    parser.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="with export: new or empty folder (default: RUN_NAME)",
    )


def run(args: argparse.Namespace) -> int:
    """Show, repair or verify; exit code 6 when parts of the recording are missing, damaged or changed."""
    from mimics_app.recording.run import Run
    from mimics_app.recording.verdict import evaluate

    if args.action == "export":
        return _export(args, Run.open(args.folder))
    repaired: dict[str, Any] = {}
    if args.action == "recover":
        from mimics_app.recording.recover import recover

        recovery = recover(args.folder)
        opened, verdict = Run.open(args.folder), recovery.verdict
        repaired = {"repaired": list(recovery.repaired)}
    else:
        opened = Run.open(args.folder)
        verdict = evaluate(opened)
    found = {**_describe(opened), **repaired}
    if args.action == "verify":
        found["verified"] = opened.manifest is not None and verdict.whole
    found["verdict"] = verdict.word
    found["problems"] = list(verdict.problems)
    found["notes"] = opened.notes()
    lines = _info(found) if args.action == "info" else _verdict_lines(opened, verdict, found.get("repaired"))
    lines += [("note", note) for note in found["notes"]]
    answer(args, {"action": args.action, **found}, (f"{name:14} {text}" for name, text in lines))
    return 0 if verdict.whole else PartialDataError.exit_code


def _export(args: argparse.Namespace, opened: Run) -> int:
    from mimics_app.app.terminal.progress import ProgressBar
    from mimics_app.recording.exporter_kinds import export_run

    folder = args.output or args.folder.resolve().with_name(f"{args.folder.resolve().name}_{args.to}")
    with ProgressBar(sys.stderr) as bar:
        files = export_run(opened, args.to, folder, lambda share: bar.show(share, f"{args.to}: {folder.name}"))
    problems = opened.problems()
    found = {"action": "export", "files": [str(file) for file in files], "problems": problems}
    answer(args, found, [*map(str, files), *(f"problem        {problem}" for problem in problems)])
    return PartialDataError.exit_code if opened.losses() else 0


def _describe(opened: Run) -> dict[str, Any]:
    rows = opened.haptic
    return {
        "run_dir": str(opened.folder),
        "status": opened.status,
        "seconds": opened.end_of_ticks / TICKS_PER_SECOND,
        "ticks": len(rows),
        "events": len(opened.events),
        "trials": len(opened.trials),
        "parameters": len(opened.parameters),
        "state_hash": opened.manifest.state_hash if opened.manifest else opened.state_hash(),
        "gaps": [asdict(gap) for gap in opened.gaps],
    }


def _verdict_lines(opened: Run, verdict: Verdict, repaired: list[str] | None) -> list[tuple[str, str]]:
    """Return the verdict as one line, the repairs, and each loss or damage."""
    lines = [(verdict.word, f"{opened.folder}: {_verdict(opened, verdict)}")]
    if repaired is not None:
        lines.append(("repaired", ", ".join(repaired) or _no_repair(verdict)))
    return lines + [("problem", sentence) for sentence in verdict.losses]


def _verdict(opened: Run, verdict: Verdict) -> str:
    if opened.being_recorded:
        return "its session is still running"
    if opened.manifest is None:
        return f"it was never closed; mimics record recover {opened.folder} closes it and keeps what is good"
    if verdict.fresh:
        return counted(len(verdict.losses), "findings")
    if not verdict.whole:
        lost = counted(len(verdict.losses), "losses") if verdict.losses else "no losses"
        return f"{lost}; the rest is unchanged since the run was closed"
    files = len(opened.manifest.files)
    return f"{files} files and the state hash match their checksums, {len(opened.haptic)} ticks without a gap"


def _no_repair(verdict: Verdict) -> str:
    """Return why nothing was repaired."""
    if not verdict.losses:
        return "nothing: there is nothing to recover"
    return "nothing: lost or damaged data cannot be recovered and stays as it is"


def _info(found: dict[str, Any]) -> list[tuple[str, str]]:
    plain = [(name, str(item)) for name, item in found.items() if not isinstance(item, list)]
    return plain + [("problem", problem) for problem in found["problems"]]
