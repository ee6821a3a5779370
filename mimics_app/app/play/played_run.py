"""Content of the page of results, from a run folder: of the session just played, or of an earlier one."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast, get_args

from mimics_app.app.play.outcome import result_content
from mimics_app.app.play.session_keys import session_keys
from mimics_app.app.session.mover import Mover
from mimics_app.recording.history import earlier_runs, local_time
from mimics_app.recording.manifest import read_manifest
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.session_header import read_session
from mimics_app.recording.session_totals import session_totals
from mimics_app.recording.trial_table import read_trials
from mimics_app.rendering.visual.launcher.result_page import ResultContent

__all__ = ["played_run"]

_CUT_OFF = "This session was cut off. mimics record recover {} repairs its recording"


def played_run(folder: Path, *, from_launcher: bool) -> ResultContent:
    """Return the content of the page.

    Args:
        folder: Run folder, also of a session that was cut off.
        from_launcher: Whether closing the page leads back to the launcher.
    """
    header, _ = read_session(folder)
    manifest, _ = read_manifest(folder)
    rows = _rows(folder)
    task = session_totals({} if manifest is None else manifest.summary, rows)
    scene = mapping(header.get("scene"))
    return result_content(
        str(scene.get("title") or scene.get("name") or folder.name),
        {"task": {"completed": 0, "trials": 0, **task}},
        rows,
        earlier_runs(folder),
        _keys(header),
        who=_who(header),
        footnote=_CUT_OFF.format(folder) if manifest is None else f"Recorded in {folder}",
        from_launcher=from_launcher,
    )


def _rows(folder: Path) -> list[dict[str, Any]]:
    try:
        return read_trials(folder / FILES["trials"])
    except OSError:
        return []


def _keys(header: dict[str, Any]) -> Any:
    mover = mapping(header.get("moved_by")).get("person")
    return session_keys(cast("Mover", mover) if mover in get_args(Mover) else "at the pointer")


def _who(header: dict[str, Any]) -> str:
    """Return participant and local time of the start of a run."""
    participant = str(mapping(header.get("settings")).get("participant", ""))
    begun = local_time(str(mapping(header.get("clock")).get("utc", "")))
    return "  ·  ".join(part for part in (participant and f"Participant {participant}", begun) if part)
