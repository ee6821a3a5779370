"""Forms of admittance control (D2.1 equations 6, 7) with their cost and spurious force."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic import AdmittanceForm
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.admittance import VirtualMass, admit
from mimics_app.rendering.haptic.kernels.kinematics import apply_inverse_jacobian, apply_jacobian

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats

__all__ = ["false_force"]


_D1 = 0.46
_MASS = 3.0
_DT = 1e-3
"""Tick of the loop [s]: the spurious force of a form grows with it."""
_FREE = 1e9
_CALLS = 20_000


@kernel
def _run(form: int, calls: int, dt: float, q: Floats, v: Floats, dq: Floats, scratch: Floats) -> None:
    force = np.zeros(3)
    for _ in range(calls):
        admit(form, q, force, VirtualMass(_MASS, 0.0, _FREE, _FREE), _D1, dt, scratch, v, dq)


def _moving() -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return q, v and dq of a free mass at r = 0.46 m with r' = 0.2 m/s and phi' = 1 rad/s."""
    q, dq, v = np.zeros(3), np.array([0.2, 1.0, 0.0]), np.zeros(3)
    apply_jacobian(q, _D1, dq, v)
    return q, v, dq


def false_force(form: AdmittanceForm) -> float:
    """Return the spurious force of a form on a free mass of 3 kg [N]: mass times change of its velocity per tick."""
    q, v, dq = _moving()
    before = v.copy()
    _run(int(form), 1, _DT, q, v, dq, np.zeros(3))
    # The joints have moved by one step: the velocity is evaluated at the new position.
    q_next = q + _DT * dq
    after = np.zeros(3)
    if form is AdmittanceForm.CARTESIAN:
        apply_inverse_jacobian(q_next, _D1, v, dq)
    apply_jacobian(q_next, _D1, dq, after)
    return float(_MASS * np.linalg.norm(after - before) / _DT)


def _cost_us(form: AdmittanceForm) -> float:
    q, v, dq = _moving()
    return shortest_us(lambda: _run(int(form), _CALLS, 0.0, q, v, dq, np.zeros(3)), _CALLS)


compare(
    __name__,
    "a free virtual mass of 3 kg that moves and turns; error: the force a form invents on it",
    "N",
    [
        Rival(
            "cartesian",
            "Newton's law in the robot frame, joints through the inverse Jacobian",
            "r > 0",
            {"form": "cartesian"},
            (AdmittanceForm.CARTESIAN,),
        ),
        Rival(
            "polar",
            "(6) and (7) with the centrifugal and Coriolis terms they leave out",
            "r > 0",
            {"form": "polar"},
            (AdmittanceForm.POLAR,),
        ),
        Rival(
            "seed",
            "(6) and (7) as printed, axis by axis",
            "demonstration: no rotation, or no speed",
            {"form": "seed"},
            (AdmittanceForm.SEED,),
        ),
    ],
    Probes(_cost_us, false_force),
    default="cartesian",
)
