"""Which head a session hears with: the person's own from a SOFA file, or one computed for the width of the head."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from mimics_app.rendering.audio.settings import AudioSettings
from mimics_app.rendering.audio.spectral.computed_head import compute_head
from mimics_app.rendering.audio.spectral.head_table import HeadTable, build_head_table
from mimics_app.rendering.audio.spectral.sofa import read_sofa

__all__ = ["head_table"]


def head_table(settings: AudioSettings) -> HeadTable:
    """The tables of the head that the settings name; those of one head are made once in a process.

    Raises:
        SceneError: The SOFA file cannot be used; the reason is said.
    """
    return _table(settings.sofa, settings.head_width, settings.rate)


@lru_cache(maxsize=4)
def _table(sofa: Path | None, width: float, rate: int) -> HeadTable:
    head = compute_head(width, rate) if sofa is None else read_sofa(sofa)
    return build_head_table(head, rate)
