"""Port of whoever times the stages of a frame; nobody does by default."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from typing import Protocol

__all__ = ["UNTIMED", "StageTimer"]


class StageTimer(Protocol):
    """Times named stages of a frame, one after another."""

    def stage(self, name: str) -> AbstractContextManager[None]:
        """What happens within it is the time of that stage; stages do not lie in each other."""
        ...


class _Untimed:
    def __init__(self) -> None:
        self._nothing = nullcontext()

    def stage(self, name: str) -> AbstractContextManager[None]:
        return self._nothing


UNTIMED: StageTimer = _Untimed()
"""Times nothing."""
