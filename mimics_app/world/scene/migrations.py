"""Older versions of the scene format, brought up to date by pure functions from document to document."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mimics_app.world.scene.spec import VERSION

__all__ = ["MIGRATIONS", "migrate"]

MIGRATIONS: dict[int, Callable[[dict[str, Any]], dict[str, Any]]] = {}
"""From version n to n + 1, by n. Each returns a new document and leaves the old one as it is."""


def migrate(document: dict[str, Any]) -> dict[str, Any] | None:
    """The document in the newest version, or None when its version cannot be read: too new, too old or no number."""
    version = document.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version > VERSION:
        return None
    for step in range(version, VERSION):
        if step not in MIGRATIONS:
            return None
        document = MIGRATIONS[step](document) | {"version": step + 1}
    return document
