"""Texts of the operator's page, from its own files, for the catalogues of the languages (`assets/builders/texts`).

A text is what an element with `data-text` holds, what a script gives to `t` or `mark`, and what the page is sent.
"""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path

from mimics_app.contracts.loop.device_faults import FAULT_WORDS

__all__ = ["page_texts"]

_FOLDER = Path(__file__).parent

_IN_SCRIPT = re.compile(r'\b(?:t|mark)\(\s*("(?:[^"\\]|\\.)*")')
_FROM_SESSION = (
    "The session is over.",
    "The application is gone: it crashed or was killed. Its recording can be repaired: mimics record recover.",
    "finished", "timeout", "aborted", "from the left", "from the right", "from above",
)  # fmt: skip
"""Texts that the page is sent and shows in the reader's language."""


def page_texts() -> dict[str, list[str]]:
    """Return the texts, each with the files that have it, in the order of the files."""
    found: dict[str, list[str]] = {}
    for file in sorted(_FOLDER.glob("page/*.html")) + sorted(_FOLDER.glob("page/*.js")):
        source, place = file.read_text(encoding="utf-8"), file.relative_to(_FOLDER).as_posix()
        for text in {".html": _in_html, ".js": _in_script}[file.suffix](source):
            places = found.setdefault(text, [])
            if place not in places:
                places.append(place)
    for text in (*FAULT_WORDS.values(), *_FROM_SESSION):
        found.setdefault(text, []).append("session")
    return found


class _Marked(HTMLParser):
    """Collects what the elements with `data-text` hold."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = any(name == "data-text" for name, _ in attrs)

    def handle_endtag(self, tag: str) -> None:
        self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside and data.strip():
            self.texts.append(data)


def _in_html(source: str) -> list[str]:
    parser = _Marked()
    parser.feed(source)
    return parser.texts


def _in_script(source: str) -> list[str]:
    return [str(json.loads(quoted)) for quoted in _IN_SCRIPT.findall(source)]
