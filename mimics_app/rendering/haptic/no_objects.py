"""The objects' part of the tick: imported where a scene has objects, and what stands in its place where it has none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import typed_kernel
from mimics_app.contracts.loop_ports import FIELD, MAX_FIELDS
from mimics_app.contracts.object_rows import Rows
from mimics_app.rendering.haptic.objects import SIMULATE, ObjectWork

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import Fields, ObjectCountsRecord, Simulate

__all__ = ["NO_FIELDS", "load_simulation", "no_field", "no_objects"]


@typed_kernel(FIELD)
def no_field(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """No force: what stands in the places of fields a session does not have."""
    out[0] = 0.0
    out[1] = 0.0
    out[2] = 0.0


NO_FIELDS: Fields = (no_field,) * MAX_FIELDS
"""The force fields of a session without any."""


@typed_kernel(SIMULATE)
def no_objects(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, hand: Vec, fields: Fields, dt: float, force: Vec
) -> None:
    """Nothing is touched: the results of a tick stay as they were made."""


def load_simulation() -> Simulate:
    """The objects' part of the tick, imported and compiled when it is first needed."""
    from mimics_app.rendering.haptic.simulate import simulate_objects

    return simulate_objects
