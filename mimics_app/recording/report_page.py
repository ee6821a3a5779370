"""Makes HTML of what a report shows: the templates beside this module, every text escaped by the template engine."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.recording.report_values import shown

if TYPE_CHECKING:
    from jinja2 import Environment

    from mimics_app.recording.report import Page

__all__ = ["render_page"]

_TEMPLATES = Path(__file__).parent / "templates"


def render_page(page: Page) -> str:
    """The page of a report; text that UTF-8 cannot hold is written as question marks."""
    text = _environment().get_template("report.html.j2").render(page=page)
    return text.encode("utf-8", "replace").decode()


@cache
def _environment() -> Environment:
    """The template engine, imported here: a run that writes no report does not need it."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["shown"] = shown
    return environment
