"""Writes the built-in sounds as wave files to listen to; the application itself makes them when it starts.

python assets/sounds/build_sounds.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.rendering.audio.bank import write_sounds
from mimics_app.rendering.audio.settings import AudioSettings


def main(folder: Path) -> None:
    """Write every recipe, and every speed step of a contact."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in write_sounds(folder, AudioSettings().sounds):
        print(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
