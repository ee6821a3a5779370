"""Friction laws with their cost and the drift of an object that they should hold.

Probe: a body of 0.5 kg slides at 0.5 m/s, is stopped by friction of 4 N, and from 0.5 s on carries a load of 1 N that
oscillates by 0.5 N at 5 Hz, well inside the cone, for 62 s at 1 ms, damped with 5 N s/m by the hand.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.lab.haptic.friction_laws import Bristles, karnopp, lugre_explicit, lugre_implicit, regularised
from mimics_app.lab.haptic.printed_equations import regularised_printed
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.contact_records import FRICTION
from mimics_app.rendering.haptic.kernels.friction import hayward_armstrong

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FrictionRecord, Table

__all__ = ["KARNOPP", "LAWS", "NUMBERS", "Hold", "friction_by", "hold"]


LAWS: dict[str, Callable[..., None]] = {
    "4.3.2 printed": regularised_printed,
    "regularised": regularised,
    "Karnopp": karnopp,
    "Hayward-Armstrong": hayward_armstrong,
    "LuGre explicit": lugre_explicit,
    "LuGre implicit": lugre_implicit,
}
"""The laws by name, in the order of their numbers in the compiled loops."""

NUMBERS = {name: number for number, name in enumerate(LAWS)}

KARNOPP, _LUGRE_EXPLICIT = 2, 4
"""Numbers of two laws."""

_MASS = 0.5  # [kg]
_NORMAL = 10.0  # [N]
_MU = 0.4
_THRESHOLD = 0.01  # [m/s]
_BRISTLES = 1e5  # [N/m]
_HAND = 5.0  # [N s/m]
_SPEED = 0.5  # [m/s]
_DT = 1e-3
_LOADED = 500  # tick from which the load acts
_SETTLING_TICKS = 2500  # tick from which drift is counted, two seconds later
_HELD = 60_000  # ticks: whole periods of the shaking load
_TICKS = _SETTLING_TICKS + _HELD + 1
_CALLS = 20_000
_FAILED = 1.01  # of the cone: what has left it by more holds nothing

_SHAKE_HZ = 5.0
"""Frequency of the load."""

_SQUARE_RATE = 100.0
"""Square of the angular frequency of a sliding oscillation [rad^2/s^2]."""


@dataclass(frozen=True, slots=True)
class Hold:
    """Motion of an object that a law should hold.

    Attributes:
        drift: Distance between its positions 2 s and 62 s after the start of the load, at equal load [m].
        cone: Largest friction force over mu F_N; 1 is on the cone.
        stop: Position at rest before the load [m].
    """

    drift: float
    cone: float
    stop: float


@kernel
def friction_by(
    number: int,
    x: F8,
    v: F8,
    load: F8,
    normal: float,
    numbers: Bristles,
    dt: float,
    state: FrictionRecord,
    out: F8,
) -> None:
    """Compute the friction force [N] by the law of a number in `LAWS`; vectors in the plane of the contact, shape [n].

    Args:
        number: Number of the law.
        x: Position of the body [m].
        v: Its velocity [m/s].
        load: Tangential load on it [N].
        normal: Normal force [N].
        numbers: Of every law: its coefficient, the Stribeck velocity also that of a transition to rest, the stiffness
            also that of an anchor.
        dt: Tick [s].
        state: State of the law.
        out: Receives the force on the body.
    """
    mu, threshold, stiffness = numbers.mu, numbers.stribeck, numbers.stiffness
    if number == 0:
        regularised_printed(v, normal, mu, threshold, out)
    elif number == 1:
        regularised(v, normal, mu, threshold, out)
    elif number == KARNOPP:
        karnopp(v, load, normal, mu, numbers.mu_static, threshold, state, out)
    elif number == 3:
        hayward_armstrong(x, normal, mu, stiffness, state, out)
    elif number == _LUGRE_EXPLICIT:
        lugre_explicit(v, normal, numbers, dt, state, out)
    else:
        lugre_implicit(v, normal, numbers, dt, state, out)


@kernel
def _load_at(tick: int) -> float:
    return 0.0 if tick < _LOADED else 1.0 + 0.5 * math.sin(2.0 * math.pi * _SHAKE_HZ * _DT * (tick - _LOADED))


@kernel
def _hold(number: int, ticks: int, states: Table[FrictionRecord], vectors: F8, path: F8) -> float:
    """Write the position at every tick to `path` [m] and return the largest friction force [N]."""
    x, v, load, force = vectors[0], vectors[1], vectors[2], vectors[3]
    state = states[0]
    greatest = 0.0
    for tick in range(ticks):
        path[tick] = x[0]
        load[0] = _load_at(tick) - _HAND * v[0]
        friction_by(number, x, v, load, _NORMAL, Bristles(_MU, _MU, _THRESHOLD, _BRISTLES, 0.0), _DT, state, force)
        greatest = max(greatest, abs(force[0]))
        v[0] += _DT * (load[0] + force[0]) / _MASS
        if number == KARNOPP and state.sticking:
            v[0] = 0.0
        x[0] += _DT * v[0]
    return greatest


def _fresh() -> tuple[NDArray[Any], F8]:
    """Return the law's state, and rows of position, velocity, load and force of the probe body along one axis."""
    vectors = np.zeros((4, 1))
    vectors[1, 0] = _SPEED
    return np.zeros(1, FRICTION), vectors


def hold(law: str) -> Hold:
    """Simulate slide, stop and hold of the probe body under a law."""
    states, vectors = _fresh()
    path = np.empty(_TICKS)
    greatest = _hold(NUMBERS[law], _TICKS, states, vectors, path)
    drift = abs(path[_SETTLING_TICKS + _HELD] - path[_SETTLING_TICKS])
    return Hold(float(drift), float(greatest / (_MU * _NORMAL)), float(path[_LOADED]))


def _error(law: str) -> float:
    """Return the drift in 60 s [m]; infinite for a law whose force exceeds its cone by more than 1 %."""
    held = hold(law)
    return held.drift if held.cone <= _FAILED else math.inf


@kernel
def _slide(number: int, ticks: int, states: Table[FrictionRecord], x: F8, v: F8, load: F8, out: F8) -> None:
    for i in range(x.shape[0]):
        x_i, v_i, load_i, state_i, out_i = x[i], v[i], load[i], states[i], out[i]
        for _ in range(ticks):
            v_i[0] -= _DT * _SQUARE_RATE * x_i[0]
            x_i[0] += _DT * v_i[0]
            friction_by(
                number, x_i, v_i, load_i, _NORMAL, Bristles(_MU, _MU, _THRESHOLD, _BRISTLES, 0.0), _DT, state_i, out_i
            )


def _cost_us(law: str, contacts: int) -> float:
    ticks = max(1, _CALLS // contacts)
    x, v, load, out = np.zeros((4, contacts, 2))
    v[:, 0] = 0.1
    states = np.zeros(contacts, FRICTION)
    return shortest_us(lambda: _slide(NUMBERS[law], ticks, states, x, v, load, out), ticks)


compare(
    __name__,
    "friction of one contact in its plane; error: drift in 60 s of an object it should hold",
    "m",
    [
        Rival("4.3.2 printed", "as printed, without the minus sign: drives the body", "demonstration"),
        Rival(
            "regularised",
            "4.3.2 with its sign: Coulomb with a linear middle of 1 cm/s",
            "sliding; creeps at v_th F/(mu F_N); h mu F_N < 2 m v_th",
        ),
        Rival(
            "Karnopp",
            "rest within a band of velocity, where the load is cancelled (Karnopp 1985)",
            "simulated bodies, whose load is known",
        ),
        Rival(
            "Hayward-Armstrong",
            "spring to an anchor dragged at the cone (Hayward & Armstrong 2000)",
            "any tick that the anchor's spring is stable in: h^2 k_t < 4 m",
            {},
        ),
        Rival(
            "LuGre explicit",
            "bristles (Canudas de Wit, Olsson, Astrom & Lischinsky 1995), explicit Euler",
            "h < 2 g(v)/(s0 |v|)",
        ),
        Rival("LuGre implicit", "the same bristles, implicit Euler", "h^2 s0 < 4 m; creeps under a shaking load"),
    ],
    Probes(_cost_us, _error, reference_us),
    default="Hayward-Armstrong",
    growth=Growth(work="contacts", sizes=SIZES),
)
