"""A gamepad stick as a velocity: dead zone, response curve."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["StickResponse"]


@dataclass(frozen=True, slots=True)
class StickResponse:
    """How far a stick must go, and how steeply it answers.

    The dead zone is a disc, not a cross, so that a diagonal push stays diagonal; beyond it the answer begins at 0
    without a jump and reaches 1 at the rim.

    Attributes:
        dead_zone: Deflection that counts as none, 0 to below 1.
        exponent: 1 answers in proportion; larger is finer near the middle.
    """

    dead_zone: float = 0.15
    exponent: float = 1.6

    def __post_init__(self) -> None:
        if not 0.0 <= self.dead_zone < 1.0:
            raise ValueError(f"dead_zone is {self.dead_zone}, must be at least 0 and below 1")
        if not self.exponent > 0.0:
            raise ValueError(f"exponent is {self.exponent}, must be above 0")

    def answer(self, x: float, y: float) -> tuple[float, float]:
        """Velocity as a share of the largest, length at most 1, for a deflection with axes in [-1, 1]."""
        deflection = math.hypot(x, y)
        if not deflection > self.dead_zone:
            return 0.0, 0.0
        share = min((deflection - self.dead_zone) / (1.0 - self.dead_zone), 1.0) ** self.exponent
        return share * x / deflection, share * y / deflection
