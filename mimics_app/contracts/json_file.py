"""Reads small JSON files that people write, and names places in them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mimics_app.contracts.errors import Issue, SceneError

__all__ = ["pointer_step", "read_json"]


def read_json(path: Path, *, fix_missing: str, max_bytes: int = 4 << 20) -> Any:
    """The document of a JSON file in UTF-8. NaN and Infinity tokens come through as floats, to be refused by value.

    Args:
        path: The file.
        fix_missing: What to do when it cannot be read.
        max_bytes: A larger file is refused before it is read.

    Raises:
        SceneError: no such file, too large, no JSON, nested too deep.
    """
    try:
        if path.stat().st_size > max_bytes:
            raise SceneError(Issue(str(path), "", f"is larger than {max_bytes >> 20} MiB", "split it"))
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SceneError(Issue(str(path), "", error.strerror or "cannot be read", fix_missing)) from error
    except json.JSONDecodeError as error:
        raise SceneError(Issue(str(path), "", f"line {error.lineno}, column {error.colno}: {error.msg}")) from error
    except (ValueError, RecursionError) as error:
        raise SceneError(Issue(str(path), "", "is no JSON text in UTF-8")) from error


def pointer_step(name: str) -> str:
    """A key as one step of a JSON pointer (RFC 6901)."""
    return name.replace("~", "~0").replace("/", "~1")
