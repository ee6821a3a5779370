"""Position control of a leg in the gait orthosis: cost against its deviation from a walk along which it is led."""

from __future__ import annotations

from mimics_app.lab.haptic.position_rivals import POSITION_RIVALS, away, cost_us
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.rivals import Probes, compare

__all__: list[str] = []

compare(
    __name__,
    "a leg led along the reference walk at 1.4 km/h; error: root mean square of hip and knee from it",
    "rad",
    POSITION_RIVALS,
    Probes(cost_us, away, reference_us),
    default="computed torque",
    few="the two that D2.1 names in Figure 54",
    why_default="a rigid object is twice as stiff under it (leg position)",
)
