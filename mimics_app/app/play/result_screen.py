"""Page of results of a run, fresh or earlier, until the person chooses what to do next."""

from __future__ import annotations

import webbrowser
from dataclasses import replace
from pathlib import Path
from typing import Any, cast, get_args

from mimics_app.app.play.journey import Following
from mimics_app.app.play.outcome import Origin, result_content
from mimics_app.app.play.session_keys import session_keys
from mimics_app.app.session.mover import Mover
from mimics_app.contracts.clock import FRAME_NS, Clock
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.history import earlier_runs, local_time
from mimics_app.recording.manifest import read_manifest
from mimics_app.recording.report import write_report
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run_folder import FILES, private_files
from mimics_app.recording.session_header import read_session
from mimics_app.recording.session_totals import session_totals
from mimics_app.recording.trial_table import read_trials
from mimics_app.rendering.visual.launcher.result_page import ResultContent, ResultPage
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.tasks.kinds.registry import report_sections

__all__ = ["played_run", "show_result"]

_CALM_POLLS_PER_PICTURE = 6
"""Polls per picture while the person does nothing: ten pictures a second are enough for a page that stands still."""

_CUT_OFF = phrase("This session was cut off. mimics record recover {folder} repairs its recording")


def played_run(folder: Path, *, origin: Origin) -> ResultContent:
    """Return the content of the page.

    Args:
        folder: Run folder, also of a session that was cut off.
        origin: Where the page leads back to.
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
        footnote=_CUT_OFF.format(folder=folder) if manifest is None else phrase("Recorded in {folder}", folder=folder),
        origin=origin,
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
    who = participant and phrase("Participant {code}", code=participant)
    return " · ".join(part for part in (who, begun) if part)


def show_result(surface: Surface, folder: Path, clock: Clock, *, origin: Origin) -> Following:
    """Show the page of a run and return the person's choice.

    Args:
        surface: The window of the pages.
        folder: Run folder, also of a session that was cut off.
        clock: Clock of real time.
        origin: Where the page leads back to.
    """
    content = played_run(folder, origin=origin)
    while True:
        choice = _choose(surface, content, clock)
        if choice != "report":
            return cast("Following", choice)
        content = replace(content, footnote=_open_report(folder))


def _open_report(folder: Path) -> str:
    """Open the report in a browser, written first where there is none; return what happened."""
    report = folder / "report.html"
    try:
        if not report.exists():
            with private_files():
                report = write_report(folder, report_sections())
    except (OSError, MimicsError) as error:
        return phrase("The report cannot be written: {error}", error=error)
    opened = webbrowser.open(report.resolve().as_uri())
    if opened:
        return phrase("The report opens in the browser; if it does not, open {file}", file=report.resolve())
    return phrase("No browser was found; open {file}", file=report.resolve())


def _choose(surface: Surface, content: ResultContent, clock: Clock) -> str:
    page = ResultPage(surface, content)
    surface.poll()  # discard keys that were pressed before the page was visible
    calm = 0
    try:
        while not surface.should_close:
            events = surface.poll()
            page.handle(events)
            if page.choice:
                return page.choice
            if calm % _CALM_POLLS_PER_PICTURE == 0 or events:
                page.draw()
                surface.swap()
            calm = 1 if events else calm + 1
            clock.sleep_until_ns(clock.now_ns() + FRAME_NS)
        return "close"
    finally:
        page.release()
