"""Position control of a leg in the gait orthosis (D2.1 Figure 54): cost against how far a rigid object yields."""

from __future__ import annotations

from mimics_app.lab.haptic.position_rivals import POSITION_RIVALS, cost_us, yielding
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.rivals import Probes, compare

__all__: list[str] = []

compare(
    __name__,
    "a person presses the foot with 60 N on a rigid wall of combined control; error: how far it gets into it",
    "m",
    POSITION_RIVALS,
    Probes(cost_us, yielding, reference_us),
    default="computed torque",
    few="the two that D2.1 names in Figure 54",
)
