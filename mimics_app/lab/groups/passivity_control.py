"""Controllers of the energy of a contact, with their cost and the shaking that they bring.

Probe: a hand of 800 N/m and 8 N s/m puts a device of 0.2 kg, whose friction is 0.5 N s/m, on an undamped plate and
lifts it off, for 4 s at 1 kHz. A force acts two ticks late; the encoder's quantum is 20 um. With no controller the
plate returns more than it took. Error: the mean force that is taken away during a contact, the largest over plates of
200, 400 and 600 N/m; infinite for a controller with which a contact returns more than 0.1 mJ that it never took, which
pushes harder than the plate or pulls, or whose force shakes by more than 0.1 N within 20 to 300 Hz.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.noise import quantised
from mimics_app.rendering.haptic.kernels.passivity_control import contact_scale, stored_share

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import Vec

__all__ = ["CONTROLLERS", "Press", "press"]

CONTROLLERS = ("none", "damper after the fact", "damper before the tick", "reference energy", "bounded by the energy")
"""By name, in the order of their numbers in the compiled loops."""

_AFTER, _BEFORE, _REFERENCE = 1, 2, 3

_DT = 1e-3  # [s]
_TICKS = 4000
_LATE = 2  # ticks until a force acts
_SUBSTEPS = 10
_MASS, _FRICTION = 0.2, 0.5  # of the device [kg, N s/m]
_ARM_STIFFNESS, _ARM_DAMPING = 800.0, 8.0  # [N/m, N s/m]
_QUANTUM = 2e-5  # [m]
_REACH = (-0.02, 0.04)  # of the hand, from the surface [m]
_PRESS_HZ = 0.75
_PLATES = (200.0, 400.0, 600.0)  # [N/m]
_MOST_DAMPING = 300.0  # [N s/m]
_MOST_FORCE = 25.0  # [N]
_BAND = (20.0, 300.0)  # [Hz]
_WINDOW = 100  # ticks
_GIVEN = 1e-4  # [J]
_BEYOND = 1e-6  # [N]
_SHAKING = 0.1  # [N]
_CALLS = 20_000
_TIMED_STIFFNESS, _TIMED_DEPTH, _TIMED_STEP = 600.0, 1e-3, 1e-6  # of the contact whose ticks are timed [N/m, m, m]
_TIMED_TICKS = 100  # after which it begins anew
_TIMED_ENERGY = 0.25e-3  # at that depth: below the spring's 0.3 mJ, so that a controller has work to do [J]

_FORCE, _VIRTUAL, _DEPTH, _WORK = 0, 1, 2, 3
"""Columns of a press: felt and virtual force [N], depth [m], work taken from the hand in the tick [J]."""


@dataclass(frozen=True, slots=True)
class Press:
    """What the hand feels of a plate, over all presses of a run.

    Attributes:
        shaking: Largest root mean square over 100 ms of the force within 20 to 300 Hz, 100 ms after a contact on [N].
        given: Largest energy that a contact returned without having taken it [J].
        beyond: Largest force beyond the virtual one, or against the hand's way out [N].
        contacts: Times that the force begins; three were meant.
        taken: Mean force that was taken away during a contact [N].
        share: The same as a share of the mean virtual force [-].
    """

    shaking: float
    given: float
    beyond: float
    contacts: int
    taken: float
    share: float


@kernel
def _reference_share(taken: float, depth: float, force: float) -> float:
    """Share 0-1 with which a spring gives all that was taken [J], evenly over the depth that is left [m].

    A force held for a tick and late by n has taken, or will give, what the force of 2 n + 1 ticks before [N] would.
    """
    return min(1.0, max(0.0, 2.0 * taken / (depth * force))) if force > 0.0 else 1.0


@kernel
def _controlled(
    number: int, force: float, sums: Vec, moved: float, depth: float, vectors: F8, line: Vec, k: int
) -> float:
    """Force of a controller [N].

    Args:
        number: Of the controller.
        force: Virtual force [N].
        sums: Energy taken so far [J], and the sum of the forces on their way [N].
        moved: Motion into the plate since the last tick [m].
        depth: In the plate [m].
        vectors: Scratch, force and velocity, shape [2, 3].
        line: Virtual force by tick [N].
        k: Tick.
    """
    v = moved / _DT
    taken = sums[0]
    if number == _AFTER:
        damping = min(_MOST_DAMPING, -taken / (_DT * v * v)) if taken < 0.0 and v != 0.0 else 0.0
        return force + damping * v
    if number == 0 or force <= 0.0:
        return force
    known = taken + sums[1] * moved  # forces on their way move the device as far as the last tick did
    vectors[0, 0], vectors[1, 0] = force, -v
    share = contact_scale(known, vectors[0], vectors[1], _DT, _MOST_DAMPING)
    if number == _REFERENCE:
        share = min(share, _reference_share(taken, depth, line[k - 2 * _LATE - 1]))
    elif number != _BEFORE:
        share = min(share, stored_share(known, force, force, depth, -moved))
    return share * force


@kernel
def _press(number: int, stiffness: float, out: F8, line: Vec, sums: Vec, vectors: F8) -> None:
    """Fill the columns of a press."""
    x, v, shown = _REACH[0], 0.0, _REACH[0]
    low, high = _REACH
    for k in range(2 * _LATE + 1, out.shape[0]):
        last = shown
        shown = quantised(x, _QUANTUM)
        sums[0] += out[k - 1 - _LATE, _FORCE] * (shown - last)
        depth = max(0.0, shown)
        force = min(_MOST_FORCE, spring_damper(depth, (shown - last) / _DT, stiffness, 0.0))
        if depth == 0.0 and out[k - 1, _DEPTH] == 0.0:
            sums[0] = 0.0
        sums[0] = min(sums[0], stiffness * depth * depth)
        line[k] = force
        sums[1] = 0.0
        for n in range(1, _LATE + 1):
            sums[1] += out[k - n, _FORCE]
        rendered = _controlled(number, force, sums, shown - last, depth, vectors, line, k)
        out[k, _FORCE], out[k, _VIRTUAL], out[k, _DEPTH] = rendered, force, depth
        before = x
        for i in range(_SUBSTEPS):
            t = (k + i / _SUBSTEPS) * _DT
            phase = 2.0 * math.pi * _PRESS_HZ * t
            aim = low + 0.5 * (high - low) * (1.0 - math.cos(phase))
            speed = 0.5 * (high - low) * 2.0 * math.pi * _PRESS_HZ * math.sin(phase)
            push = _ARM_STIFFNESS * (aim - x) + _ARM_DAMPING * (speed - v) - out[k - _LATE, _FORCE] - _FRICTION * v
            v += push / _MASS * _DT / _SUBSTEPS
            x += v * _DT / _SUBSTEPS
        out[k, _WORK] = out[k - _LATE, _FORCE] * (x - before)


def _runs(rendered: F8) -> list[tuple[int, int]]:
    """First tick, and the one behind the last, of every contact; a pause of less than 20 ms does not end it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rendered > 0.0, [0]]).astype(int)))
    runs: list[tuple[int, int]] = []
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        joined = runs and begin - runs[-1][1] < 20
        runs = [*runs[:-1], (runs[-1][0], int(end))] if joined else [*runs, (int(begin), int(end))]
    return runs


def _shaking(force: F8, runs: list[tuple[int, int]]) -> float:
    """Largest root mean square in the band over 100 ms of the force [N], from 100 ms after each contact began on."""
    spectrum = np.fft.rfft(force)
    frequency = np.fft.rfftfreq(len(force), _DT)
    spectrum[(frequency < _BAND[0]) | (frequency > _BAND[1])] = 0.0
    square = np.convolve(np.fft.irfft(spectrum, len(force)) ** 2, np.full(_WINDOW, 1.0 / _WINDOW))
    counted = np.zeros(len(square), bool)
    for begin, end in runs:
        counted[begin + 2 * _WINDOW : end] = True
    return float(np.sqrt(square[counted].max(initial=0.0)))


def press(controller: str, stiffness: float) -> Press:
    """Return what the hand feels of a plate [N/m] with a controller."""
    out, line = np.zeros((_TICKS, 4)), np.zeros(_TICKS)
    _press(CONTROLLERS.index(controller), stiffness, out, line, np.zeros(2), np.zeros((2, 3)))
    rendered, virtual = out[:, _FORCE], out[:, _VIRTUAL]
    runs = _runs(rendered)
    given = max((-float(out[begin : end + 20, _WORK].sum()) for begin, end in runs), default=0.0)
    return Press(
        _shaking(rendered, runs),
        given,
        float(np.maximum(rendered - virtual, -rendered).max()),
        int((np.diff((rendered > 0.0).astype(int)) == 1).sum()),
        float((virtual - rendered).sum() / np.count_nonzero(virtual)),
        float(1.0 - rendered.sum() / virtual.sum()),
    )


def _error(controller: str) -> float:
    """Return the largest force taken away [N]; infinite for what gives energy, adds force or shakes."""
    presses = [press(controller, stiffness) for stiffness in _PLATES]
    sound = all(each.given <= _GIVEN and each.beyond <= _BEYOND and each.shaking <= _SHAKING for each in presses)
    return max(each.taken for each in presses) if sound else math.inf


@kernel
def _drive(number: int, ticks: int, sums: Vec, vectors: F8, line: Vec) -> float:
    """Run ticks of a contact that moves out, near the limit of its energy; return the sum of the forces [N]."""
    total = 0.0
    for k in range(ticks):
        depth = _TIMED_DEPTH + _TIMED_STEP * (k % _TIMED_TICKS)
        force = _TIMED_STIFFNESS * depth
        sums[0], line[k] = _TIMED_ENERGY * depth / _TIMED_DEPTH, force
        total += _controlled(number, force, sums, -_TIMED_STEP, depth, vectors, line, k)
    return total


def _cost_us(controller: str) -> float:
    number, sums, vectors = CONTROLLERS.index(controller), np.zeros(2), np.zeros((2, 3))
    line = np.zeros(_CALLS)
    return shortest_us(lambda: _drive(number, _CALLS, sums, vectors, line), _CALLS)


compare(
    __name__,
    "energy of a contact on a device with delay; error: mean force taken away to keep it",
    "N",
    [
        Rival("none", "the virtual force as it is", "damped contacts: b > K T / 2 + K delay"),
        Rival(
            "damper after the fact",
            "a damper -E / (T v^2) once a contact gave energy (Hannaford & Ryu 2002)",
            "devices without delay; pushes harder than the contact, and pulls",
        ),
        Rival(
            "damper before the tick",
            "the same damper against the work of the coming tick, within the force",
            "the last tick of a contact: it cuts the force in one step",
        ),
        Rival(
            "reference energy",
            "what is missing is taken evenly on the way out (after Ryu, Preusche, Hannaford & Hirzinger 2005)",
            "contacts whose depth is known; softer by 4 to 10 %",
        ),
        Rival(
            "bounded by the energy",
            "F^2 <= 2 K E: what the energy could store in the spring (in the manner of Kim & Ryu 2010)",
            "contacts whose stiffness is known; softer by 2 %",
            {},
        ),
    ],
    Probes(_cost_us, _error, reference_us),
    default="bounded by the energy",
)
