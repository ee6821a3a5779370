"""Template of the page's gettext catalogues, from its own files: `python -m mimics_app.console.page_texts`.

A text is what an element with `data-text` holds, what a script gives to `t` or `mark`, and what a light before a
session says. A translation is `locale/LANGUAGE/LC_MESSAGES/console.po`; `msgfmt` makes the `console.mo` beside it.
"""

from __future__ import annotations

import ast
import json
import re
from html.parser import HTMLParser
from pathlib import Path

from mimics_app.contracts.loop.device_faults import FAULT_WORDS

__all__ = ["TEMPLATE", "page_texts", "template"]

_FOLDER = Path(__file__).parent
TEMPLATE = _FOLDER / "locale" / "console.pot"
"""The template, as it is kept."""

_IN_SCRIPT = re.compile(r'\b(?:t|mark)\(\s*("(?:[^"\\]|\\.)*")')
_FROM_SESSION = (
    "The session is over.",
    "The application is gone: it crashed or was killed. Its recording can be repaired: mimics record recover.",
    "finished", "timeout", "aborted", "from the left", "from the right", "from above",
)  # fmt: skip
"""Texts that the page is sent and shows in the reader's language."""
_HEAD = (
    "# Texts of the operator's page.\n#\n"
    'msgid ""\nmsgstr ""\n"Content-Type: text/plain; charset=UTF-8\\n"\n"Content-Transfer-Encoding: 8bit\\n"\n'
)


def page_texts() -> dict[str, list[str]]:
    """Return the texts, each with the files that have it, in the order of the files."""
    found: dict[str, list[str]] = {}
    for file in sorted(_FOLDER.glob("page/*.html")) + sorted(_FOLDER.glob("page/*.js")) + [_FOLDER / "readiness.py"]:
        source, place = file.read_text(encoding="utf-8"), file.relative_to(_FOLDER).as_posix()
        for text in {".html": _in_html, ".js": _in_script, ".py": _in_lights}[file.suffix](source):
            places = found.setdefault(text, [])
            if place not in places:
                places.append(place)
    for text in (*FAULT_WORDS.values(), *_FROM_SESSION):
        found.setdefault(text, []).append("session")
    return found


def template() -> str:
    """Return the content of the template."""
    entries = [
        f'#: {" ".join(places)}\nmsgid {json.dumps(text, ensure_ascii=False)}\nmsgstr ""\n'
        for text, places in page_texts().items()
    ]
    return "\n".join([_HEAD, *entries])


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


def _in_lights(source: str) -> list[str]:
    """Return the whole texts that are given to a `Light`, without those that have a value within."""
    lights = [
        node
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Light"
    ]
    written = [
        part.value
        for light in lights
        for given in (light.args[0], *light.args[2:])
        for part in ast.walk(given)
        if isinstance(part, ast.Constant) and isinstance(part.value, str)
    ]
    return [text for text in written if text and text not in ("green", "amber", "red")]


if __name__ == "__main__":
    TEMPLATE.parent.mkdir(exist_ok=True)
    TEMPLATE.write_text(template(), encoding="utf-8")
