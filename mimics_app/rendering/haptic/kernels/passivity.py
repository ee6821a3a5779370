"""Passivity observer: the energy a rendered object has taken from the user (Hannaford & Ryu 2002).

The device holds each force for a whole tick, so the work of a tick is exactly F_{k-1}.(x_k - x_{k-1}), whatever the
motion in between; T F v would err by the change of velocity. It only observes: `passivity_control` acts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import copy

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObserverRecord

__all__ = ["OBSERVER", "observe", "reset_observer"]


OBSERVER = np.dtype(
    [
        ("energy", np.float64),  # taken from the user since the reset [J]; below 0: the object is active
        ("lowest", np.float64),  # lowest energy so far [J]
        ("position", np.float64, 3),  # of the last tick [m]
        ("force", np.float64, 3),  # on the user, held since the last tick [N]
        ("known", np.uint8),  # 1: position and force are valid
    ],
    align=True,
)
"""State of one observer; zeros are the initial state."""


@kernel
def reset_observer(observer: ObserverRecord) -> None:
    """Restart the observer at 0 J, as in free motion."""
    observer.energy = 0.0
    observer.lowest = 0.0
    observer.known = 0


@kernel
def observe(observer: ObserverRecord, position: Vec, force_on_user: Vec) -> float:
    """Count one tick and return the energy [J] taken from the user so far: E += (-F_{k-1}).(x_k - x_{k-1}).

    Args:
        observer: Record of `OBSERVER`, updated.
        position: Position of the device in this tick [m], shape [3].
        force_on_user: Force held from this tick to the next [N], shape [3], same frame.
    """
    if observer.known:
        work = 0.0
        for i in range(3):
            work -= observer.force[i] * (position[i] - observer.position[i])
        observer.energy += work
        observer.lowest = min(observer.lowest, observer.energy)
    copy(position, observer.position)
    copy(force_on_user, observer.force)
    observer.known = 1
    return observer.energy
