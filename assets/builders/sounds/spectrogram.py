"""Spectrograms of sounds on one sheet, to be looked at: time to the right, frequency upwards, 80 dB dark to light."""

from __future__ import annotations

import wave
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

__all__ = ["draw_spectrograms"]

_WINDOW = 1024  # samples, 21 ms at 48 kHz
_HIGHEST = 16_000.0  # Hz at the top of a picture
_RANGE_DB = 80.0
_TILE = (300, 160)  # px
_COLUMNS = 6
_LABEL = 14  # px
_LONGEST_S = 2.0


def _spectrogram_db(samples: NDArray[np.float64], columns: int) -> NDArray[np.float64]:
    """Level [dB] over the loudest bin, shape [bins, columns], low tones first."""
    padded = np.concatenate((np.zeros(_WINDOW // 2), samples, np.zeros(_WINDOW)))
    starts = np.linspace(0, max(1, len(samples) - 1), columns).astype(np.int64)
    frames = np.stack([padded[start : start + _WINDOW] for start in starts], axis=1)
    power = np.abs(np.fft.rfft(frames * np.hanning(_WINDOW)[:, None], axis=0)) ** 2
    return np.asarray(10.0 * np.log10(power / max(power.max(), 1e-20) + 1e-12))


def draw_spectrograms(files: Sequence[Path], picture: Path) -> None:
    """One tile per wave file, its name above it; sounds longer than 2 s are shown by their beginning."""
    width, height = _TILE
    rows = -(-len(files) // _COLUMNS)
    sheet = Image.new("RGB", (_COLUMNS * width, rows * (height + _LABEL)), "white")
    pen = ImageDraw.Draw(sheet)
    for number, file in enumerate(files):
        x, y = number % _COLUMNS * width, number // _COLUMNS * (height + _LABEL)
        samples, rate = _read(file)
        shown = samples[: int(_LONGEST_S * rate)]
        pen.text((x + 3, y + 1), f"{file.stem}  {len(samples) / rate:.2f} s", fill="black")
        level = _spectrogram_db(shown, width - 4)[: int(_HIGHEST / rate * _WINDOW)]
        light = np.clip(1.0 + level[::-1] / _RANGE_DB, 0.0, 1.0)
        colours = np.stack((light**1.2, light**2.0, np.sqrt(light) * 0.6), axis=2)
        tile = Image.fromarray((255.0 * colours).astype(np.uint8)).resize((width - 4, height - 4))
        sheet.paste(tile, (x + 2, y + _LABEL))
    sheet.save(picture)


def _read(file: Path) -> tuple[NDArray[np.float64], int]:
    with wave.open(str(file)) as sound:
        raw = np.frombuffer(sound.readframes(sound.getnframes()), "<i2").reshape(-1, sound.getnchannels())
        return raw.mean(axis=1) / 32768.0, sound.getframerate()
