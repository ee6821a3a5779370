"""Port of the timer of a frame's stages, with a null implementation."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from typing import Protocol

__all__ = ["UNTIMED", "StageTimer"]


class StageTimer(Protocol):
    """Times named stages of a frame, one after another."""

    def stage(self, name: str) -> AbstractContextManager[None]:
        """Return a context manager that times a stage; stages are not nested."""
        ...


class _Untimed:
    def __init__(self) -> None:
        self._nothing = nullcontext()

    def stage(self, name: str) -> AbstractContextManager[None]:
        return self._nothing


UNTIMED: StageTimer = _Untimed()
"""Null timer."""
