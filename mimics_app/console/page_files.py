"""What the page consists of: its files, and its texts in the language of the reader; the English ones are the keys."""

from __future__ import annotations

import mimetypes
import re
from pathlib import Path

from mimics_app.contracts.system import language

__all__ = ["catalogue", "page_files"]

_PAGE = Path(__file__).parent / "page"
_SUFFIXES = (".html", ".js", ".css", ".svg", ".LICENSE")
_TYPES = {".js": "text/javascript", ".LICENSE": "text/plain"}

_LONGEST = 200
"""Length of a header that is read [characters]."""
_TAG = re.compile(r"([A-Za-z]{2,3})(?:-[A-Za-z0-9]+)*")


def page_files() -> dict[str, tuple[bytes, str]]:
    """Return the files of the page: path -> content and media type; nothing else can be requested."""
    files = {}
    for path in sorted(_PAGE.rglob("*")):
        if path.suffix in _SUFFIXES:
            kind = _TYPES.get(path.suffix) or mimetypes.guess_type(path.name)[0] or "text/plain"
            files["/" + path.relative_to(_PAGE).as_posix()] = path.read_bytes(), kind
    return files


def catalogue(accepted: str) -> dict[str, object]:
    """Return the language that the reader prefers of those there are, its texts and plural forms by the English ones.

    Args:
        accepted: Value of the Accept-Language header.
    """
    wanted = [match.group(1).lower() for part in accepted[:_LONGEST].split(",") if (match := _TAG.match(part.strip()))]
    code = next((each for each in wanted if each in language.LANGUAGES), language.SOURCE)
    if code == language.SOURCE:
        return {"language": code, "texts": {}, "plurals": {}}
    return {"language": code, "texts": dict(language.catalogue(code)), "plurals": dict(language.plural_forms(code))}
