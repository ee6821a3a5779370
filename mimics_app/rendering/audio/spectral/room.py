"""Reverb: a feedback delay network of eight lines with an orthogonal matrix (Jot & Chaigne 1991)."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, Words

__all__ = ["Room"]


_LINES_MS = (23.3, 27.1, 31.7, 35.9, 39.1, 43.7, 47.3, 53.9)
"""Delays of the lines [ms], mutually prime in samples: echoes of a room of 8 to 18 m."""

_DAMPING = 0.35
"""Coefficient of the low-pass in each line: high frequencies decay about three times as fast as low ones."""


class Room:
    """Reverberation of an input channel.

    Args:
        rate: Samples per second.
        channels: Number of output channels, which are decorrelated.
    """

    def __init__(self, rate: int, channels: int) -> None:
        self._rate = rate
        self._lengths = np.array([int(ms * 1e-3 * rate) | 1 for ms in _LINES_MS], np.int64)
        self._lines = np.zeros((len(_LINES_MS), int(self._lengths.max())), np.float32)
        self._place = np.zeros(1, np.int64)
        self._last = np.zeros(len(_LINES_MS), np.float32)
        self._level, self._level_now = 0.0, 0.0
        self._feedback = np.zeros(len(_LINES_MS), np.float32)
        self._spread = _signs(channels)
        self.set(0.0, 1.0)

    @property
    def sounds(self) -> bool:
        """Whether the reverb is audible."""
        return max(self._level, self._level_now) > 0.0

    def set(self, level: float, seconds: float) -> None:
        """Set the linear level of the reverb and its T60 [s]."""
        self._level = float(level)
        self._feedback[:] = 10.0 ** (-3.0 * self._lengths / (self._rate * max(seconds, 0.05)))

    def add(self, sent: F4 | None, out: F4) -> None:
        """Add the reverb of a block to the mix.

        Args:
            sent: Input block, one channel; None for silence.
            out: Mix to add to, shape [frames, channels].
        """
        if not self.sounds:
            return
        silent = np.zeros(len(out), np.float32) if sent is None else sent
        gains = np.array((self._level_now, self._level), np.float32)
        _answer(silent, self._lines, self._lengths, self._place, self._last, self._feedback, self._spread, gains, out)
        self._level_now = self._level


def _signs(channels: int) -> F4:
    """Return rows of a Hadamard matrix, shape [channels, lines]: uncorrelated channels that all use every line."""
    lines = len(_LINES_MS)
    signs = [[(-1.0) ** (line & channel).bit_count() for line in range(lines)] for channel in range(channels)]
    return (np.array(signs) / np.sqrt(lines)).astype(np.float32)


@kernel
def _answer(
    sent: F4,
    lines: F4,
    lengths: Words,
    place: Words,
    last: F4,
    feedback: F4,
    spread: F4,
    gains: F4,
    out: F4,
) -> None:
    """Process a block of the feedback delay network with the Householder matrix I - 2/n."""
    count, frames = lines.shape[0], sent.shape[0]
    fed_back = np.zeros(count, np.float32)
    damping, share = np.float32(_DAMPING), np.float32(2.0 / count)
    for i in range(frames):
        total = np.float32(0.0)
        for line in range(count):
            tap = lines[line, (place[0] + i) % lengths[line]]
            last[line] += (np.float32(1.0) - damping) * (tap - last[line])
            fed_back[line] = last[line] * feedback[line]
            total += fed_back[line]
        level = gains[0] + (gains[1] - gains[0]) * np.float32((i + 1) / frames)
        for line in range(count):
            lines[line, (place[0] + i) % lengths[line]] = sent[i] + fed_back[line] - share * total
        for channel in range(out.shape[1]):
            answer = np.float32(0.0)
            for line in range(count):
                answer += spread[channel, line] * fed_back[line]
            out[i, channel] += level * answer
    place[0] += frames
