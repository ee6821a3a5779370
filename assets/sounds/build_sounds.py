"""Writes the built-in sounds as wave files to listen to; the application itself makes them when it starts.

`mimics assets build sounds --out FOLDER`, or python assets/sounds/build_sounds.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.rendering.audio.bank import write_sounds
from mimics_app.rendering.audio.settings import AudioSettings


def build(folder: Path, seed: int) -> list[Path]:
    """Write every recipe, and every speed step of a contact; recipes bring their own seeds."""
    del seed
    folder.mkdir(parents=True, exist_ok=True)
    return list(write_sounds(folder, AudioSettings().sounds))


if __name__ == "__main__":
    for path in build(Path(sys.argv[1]), 1):
        print(path)
