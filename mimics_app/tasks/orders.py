"""Filter of the parameters sent to the renderers: changes only."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["Changes"]


class Changes:
    """Last value sent under each name."""

    def __init__(self) -> None:
        self._sent: dict[str, object] = {}

    def since_last(self, wanted: Mapping[str, object]) -> dict[str, object]:
        """Return the values that differ from those sent before; they count as sent."""
        changed = {name: value for name, value in wanted.items() if self._sent.get(name, _NEVER) != value}
        self._sent.update(changed)
        return changed


_NEVER = object()
