"""The built-in sounds as wave files to listen to; the application itself makes them when it starts."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.recipe import built_in_recipes
from mimics_app.rendering.audio.settings import SoundSpec
from mimics_app.rendering.audio.wav_file import WavWriter

__all__ = ["compose"]

_RATE = 48_000


def compose(seed: int) -> dict[str, bytes]:
    """Every recipe, every speed step of a contact and every take of a step; recipes bring their own seeds."""
    del seed
    bank = SoundBank({name: SoundSpec(recipe=name) for name in built_in_recipes()}, _RATE)
    files = {}
    with TemporaryDirectory() as folder:
        for name, sound in bank.sounds.items():
            path = Path(folder, f"{name.replace(':', '_')}.wav")
            writer = WavWriter(path, _RATE)
            writer.append(np.repeat(sound.samples[:, None], 2, axis=1))
            writer.close()
            files[path.name] = path.read_bytes()
    return files
