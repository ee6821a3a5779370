"""Levels of detail: what files and tables agree on."""

from __future__ import annotations

__all__ = ["MAX_LEVELS"]

MAX_LEVELS = 8
"""Levels of detail a body can have."""
