"""The built-in sounds as wave files to listen to; the application itself makes them when it starts."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from mimics_app.rendering.audio.bank import FAMILIES, RECIPES, TAKES, write_sounds
from mimics_app.rendering.audio.settings import SoundSpec

__all__ = ["compose"]


def compose(seed: int) -> dict[str, bytes]:
    """Every recipe, every speed step of a contact and every take of a step; recipes bring their own seeds."""
    del seed
    specs = {name: SoundSpec(recipe=name) for name in (*RECIPES, *FAMILIES, *TAKES)}
    with TemporaryDirectory() as folder:
        return {file.name: file.read_bytes() for file in write_sounds(Path(folder), specs)}
