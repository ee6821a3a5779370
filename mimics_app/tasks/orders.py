"""Sends only what changed: parameters of the renderers as they were last ordered."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["Changes"]


class Changes:
    """Remembers what was sent under each name."""

    def __init__(self) -> None:
        self._sent: dict[str, object] = {}

    def since_last(self, wanted: Mapping[str, object]) -> dict[str, object]:
        """The part of `wanted` that differs from what was sent before; it counts as sent."""
        changed = {name: value for name, value in wanted.items() if self._sent.get(name, _NEVER) != value}
        self._sent.update(changed)
        return changed


_NEVER = object()
