"""Plug-ins: objects that other packages offer by entry points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import short_text

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["load_plugin"]


def load_plugin(point: EntryPoint) -> Any:
    """Return the object of an entry point.

    Raises:
        ValueError: It cannot be imported; the message says why in one line, even where a compiler says it in twenty.
    """
    try:
        return point.load()
    except (Exception, SystemExit) as error:  # a third-party module may raise anything on import
        why = short_text(" ".join(f"{type(error).__name__}: {error}".split()))
        raise ValueError(f"its plug-in {point.value} cannot be imported: {why}") from error
