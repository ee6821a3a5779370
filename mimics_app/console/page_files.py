"""What the page consists of: its files, and its texts in the language of the reader as JSON of gettext catalogues.

A language is a folder `locale/LANGUAGE/LC_MESSAGES` with `console.mo`; the English texts of the page are the keys.
"""

from __future__ import annotations

import gettext
import mimetypes
import re
from functools import lru_cache
from pathlib import Path

__all__ = ["catalogue", "page_files"]

_PAGE = Path(__file__).parent / "page"
_SUFFIXES = (".html", ".js", ".css", ".svg", ".LICENSE")
_TYPES = {".js": "text/javascript", ".LICENSE": "text/plain"}

_LOCALE = Path(__file__).parent / "locale"
_DOMAIN, _SOURCE = "console", "en"
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


@lru_cache(maxsize=64)
def catalogue(accepted: str) -> dict[str, object]:
    """Return the language, and its texts by their English ones, of which the page has what the reader prefers.

    Args:
        accepted: Value of the Accept-Language header.
    """
    wanted = [match.group(1).lower() for part in accepted[:_LONGEST].split(",") if (match := _TAG.match(part.strip()))]
    for language in wanted:
        if language == _SOURCE:
            break
        found = gettext.translation(_DOMAIN, _LOCALE, [language], fallback=True)
        texts = {key: text for key, text in getattr(found, "_catalog", {}).items() if isinstance(key, str) and key}
        if texts:
            return {"language": language, "texts": texts}
    return {"language": _SOURCE, "texts": {}}
