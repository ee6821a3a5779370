"""Mixer: the built-in spectral mixer, turned down for the night."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.audio.mixer_kinds import MixerKind, find_mixer

LEVEL = np.float32(0.25)


class Night:
    """Everything at a quarter of its level.

    Args:
        inner: The mixer that does the work.
    """

    def __init__(self, inner):
        self._inner = inner

    def __getattr__(self, name):
        return getattr(self._inner, name)

    def render(self, frames):
        """Return the next block, quietly."""
        return self._inner.render(frames) * LEVEL


NIGHT = MixerKind(lambda request: Night(find_mixer("spectral").open(request)), most_voices=64)
