"""Page of results of a run, fresh or earlier, until the person chooses what to do next."""

from __future__ import annotations

import webbrowser
from dataclasses import replace
from pathlib import Path
from typing import cast

from mimics_app.app.play.journey import Following
from mimics_app.app.play.played_run import played_run
from mimics_app.contracts.clock import FRAME_NS, Clock
from mimics_app.contracts.errors import MimicsError
from mimics_app.recording.report import write_report
from mimics_app.recording.run_folder import private_files
from mimics_app.rendering.visual.launcher.result_page import ResultContent, ResultPage
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.tasks.kinds.registry import report_sections

__all__ = ["show_result"]


def show_result(surface: Surface, folder: Path, clock: Clock, *, from_launcher: bool) -> Following:
    """Show the page of a run and return the person's choice.

    Args:
        surface: The window of the pages.
        folder: Run folder, also of a session that was cut off.
        clock: Clock of real time.
        from_launcher: Whether closing the page leads back to the launcher.
    """
    content = played_run(folder, from_launcher=from_launcher)
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
        return f"The report cannot be written: {error}"
    opened = webbrowser.open(report.resolve().as_uri())
    said = "The report opens in the browser; if it does not, open" if opened else "No browser was found; open"
    return f"{said} {report.resolve()}"


def _choose(surface: Surface, content: ResultContent, clock: Clock) -> str:
    page = ResultPage(surface, content)
    surface.poll()  # discard keys that were pressed before the page was visible
    try:
        while not surface.should_close:
            page.handle(surface.poll())
            if page.choice:
                return page.choice
            page.draw()
            surface.swap()
            clock.sleep_until_ns(clock.now_ns() + FRAME_NS)
        return "close"
    finally:
        page.release()
