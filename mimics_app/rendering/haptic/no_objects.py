"""Selection of the objects' part of the tick: the simulation, imported on demand, or its stand-in without objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import FIELD, MAX_FIELDS
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.rendering.haptic.objects import SIMULATE, ObjectWork

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Fields, ObjectCountsRecord, Simulate

__all__ = ["NO_FIELDS", "load_simulation", "no_field", "no_objects"]


@typed_kernel(FIELD)
def no_field(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Null field: fills the unused places of a session's force fields."""
    out[0] = 0.0
    out[1] = 0.0
    out[2] = 0.0


NO_FIELDS: Fields = (no_field,) * MAX_FIELDS
"""Force fields of a session without any."""


@typed_kernel(SIMULATE)
def no_objects(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, hand: Vec, fields: Fields, dt: float, force: Vec
) -> None:
    """Do nothing: the results of the tick keep their initial values."""


def load_simulation() -> Simulate:
    """Import and return the objects' part of the tick."""
    from mimics_app.rendering.haptic.simulate import simulate_objects

    return simulate_objects
