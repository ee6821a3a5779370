"""Page of results in the window of a session that has ended, until the person chooses what to do next."""

from __future__ import annotations

import webbrowser
from dataclasses import replace
from pathlib import Path

from mimics_app.contracts.clock import FRAME_NS, Clock
from mimics_app.rendering.visual.launcher.result_page import ResultContent, ResultPage
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["show_result"]


def show_result(surface: Surface, content: ResultContent, report: Path, clock: Clock) -> str:
    """Show the page and return the person's choice: "again", "other" or "leave".

    Args:
        surface: The window, no longer used by the session.
        content: Content of the page.
        report: File that "Open report" opens in a browser.
        clock: Clock of real time.
    """
    while True:
        choice = _choose(surface, content, clock)
        if choice != "report":
            return choice
        opened = webbrowser.open(report.resolve().as_uri())
        said = "The report opens in the browser; if it does not, open" if opened else "No browser was found; open"
        content = replace(content, footnote=f"{said} {report.resolve()}")


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
        return "leave"
    finally:
        page.release()
