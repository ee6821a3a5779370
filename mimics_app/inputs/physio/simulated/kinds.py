"""Kinds of simulated people, which differ in heart, skin and breath at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.inputs.physio.simulated.person import Family, LatentPeople, Skin, draw_traits
from mimics_app.inputs.physio.simulated.signals import Disturbance, SignalGenerator

__all__ = ["KINDS", "Kind"]


@dataclass(frozen=True, slots=True)
class Kind:
    """What people of a kind have in common.

    Attributes:
        heart: Response of the heart rate to arousal.
        skin: What of the skin shows arousal.
        response: Shape of a skin response, a name in `shapes.RESPONSES`.
        breath: Waveform of a breath, a name in `shapes.BREATHS`.
    """

    heart: Family
    skin: Skin = "rate"
    response: str = "exponentials"
    breath: str = "rounded"

    def people(self, rng: np.random.Generator, n: int = 1, skill: float = 0.5) -> LatentPeople:
        """Draw people of this kind around a mean skill."""
        return LatentPeople(draw_traits(rng, n, self.heart, skill, self.skin), self.heart)

    def signals(self, rng: np.random.Generator, disturbance: Disturbance | None = None) -> SignalGenerator:
        """Return the signals of one person of this kind."""
        return SignalGenerator(rng, disturbance, self.response, self.breath)


KINDS = (
    Kind("linear"),
    Kind("saturating", "level", "sigmoid", "paused"),
    Kind("lagged", "amplitude", "two decays", "let go"),
    Kind("blocked", "rate", "sigmoid", "let go"),
    Kind("flipped", "rate", "two decays", "paused"),
)
"""One kind for each response of the heart; no two share heart, shape of the skin's response and breath."""
