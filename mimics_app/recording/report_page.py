"""Rendering of a report's content as HTML by the templates beside this module, with automatic escaping."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.plotting.page_templates import load_templates
from mimics_app.recording.report_values import shown

if TYPE_CHECKING:
    from mimics_app.recording.report import Page

__all__ = ["render_page"]

_TEMPLATES = Path(__file__).parent / "templates"


def render_page(page: Page) -> str:
    """Return the page of a report; characters that UTF-8 cannot encode become question marks."""
    text = load_templates(_TEMPLATES, shown=shown).get_template("report.html.j2").render(page=page)
    return text.encode("utf-8", "replace").decode()
