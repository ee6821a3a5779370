"""Effects and force fields in a tick of the loop.

Cost: what a tick takes more with one of them than without. Error: difference of its force from its law in float64.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, STATIC, EffectKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.objects.force_effects import apply_effects
from mimics_app.rendering.haptic.kernels.objects.object_inputs import (
    INPUT_LENGTH,
    INPUT_POSITION,
    INPUT_TIME,
    INPUT_VELOCITY,
)
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.kernels.objects.wires import carry_signals
from mimics_app.rendering.haptic.no_objects import NO_FIELDS
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.standard_fields import well
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Fields, ObjectCountsRecord, ObjectWork, Rows

__all__: list[str] = []


_DT, _TICKS, _RUNS = 1e-3, 3000, 20
_STIFFNESS, _DAMPING, _FORCE = 300.0, 5.0, 4.0
"""Of the effects [N/m], [N s/m], [N]."""
_RADIUS = 0.05
"""Distance within which the magnet acts, and width of the well [m]."""
_FREE = 0.005
"""Radius of the workspace [m], within that of the hand's circle."""
_RATE, _CIRCLE = 1.3, 0.012
"""Rate [1/s] and radius [m] of the hand's circle, which is inclined to all axes."""
_VIBRATION = 80.0
"""Frequency of the vibration [Hz]."""
_SLIP = 0.003
"""Distance at which stick-slip lets go [m]."""


@kernel
def _act_often(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, hands: F8, fields: Fields, forces: F8) -> None:
    _act_borrowed(borrowed(rows), borrowed(work), counts, hands, fields, forces)


@kernel
def _act_borrowed(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, hands: F8, fields: Fields, forces: F8
) -> None:
    for tick in range(hands.shape[0]):
        clear_totals(work.totals[0])
        carry_signals(rows, work, counts, hands[tick])
        apply_effects(rows, work, counts, hands[tick], fields)
        for i in range(3):
            forces[tick, i] = work.totals[0].effect_force[i]


_Law = Callable[[F8, F8, F8], F8]
"""Force [N], [n, 3], by position [m] and velocity [m/s], [n, 3], and time [s], [n]."""


@dataclass(frozen=True, eq=False)
class _Effect:
    """An effect and its law.

    Attributes:
        kind: EffectKind.
        law: The law.
        values: Fields of its EFFECT record.
    """

    kind: EffectKind
    law: _Law
    values: dict[str, float | tuple[float, ...]] = field(default_factory=dict)


def _along(x: F8, size: F8) -> F8:
    """Return vectors of a size along x."""
    return np.asarray(size[:, None] * x / np.linalg.norm(x, axis=1)[:, None])


def _pull_of_magnet(p: F8) -> F8:
    r = np.linalg.norm(p, axis=1)
    return np.asarray(np.minimum(_STIFFNESS * r, _FORCE * np.maximum(0.0, 1.0 - r / _RADIUS)))


def _pull_of_well(p: F8) -> F8:
    r = np.linalg.norm(p, axis=1) / _RADIUS
    return np.asarray(_FORCE * r * np.exp(0.5 - 0.5 * r * r))


def _stuck(p: F8) -> F8:
    """Return the force of stick-slip, tick by tick [N]."""
    anchor, forces = p[0], np.zeros_like(p)
    for tick, place in enumerate(p):
        if np.linalg.norm(place - anchor) > _SLIP:
            anchor = place
        forces[tick] = -_STIFFNESS * (place - anchor)
    return forces


_UPWARDS = (0.0, 1.0, 0.0)
_ACROSS = np.array([0.0, 1.0, 1.0])
"""What a path along x leaves of a vector."""

_EFFECTS: dict[str, _Effect] = {
    "spring": _Effect(EffectKind.SPRING, lambda p, v, t: -_STIFFNESS * p, {"stiffness": _STIFFNESS}),
    "path spring": _Effect(
        EffectKind.PATH_SPRING, lambda p, v, t: -_STIFFNESS * _ACROSS * p, {"stiffness": _STIFFNESS, "path": 0}
    ),
    "guidance": _Effect(
        EffectKind.GUIDANCE, lambda p, v, t: np.tile((_FORCE, 0.0, 0.0), (len(p), 1)), {"force": _FORCE, "path": 0}
    ),
    "viscosity": _Effect(EffectKind.VISCOSITY, lambda p, v, t: -_DAMPING * v, {"damping": _DAMPING}),
    "constant force": _Effect(
        EffectKind.CONSTANT,
        lambda p, v, t: np.tile(np.multiply(_FORCE, _UPWARDS), (len(p), 1)),
        {"force": _FORCE, "direction": _UPWARDS},
    ),
    "magnet": _Effect(
        EffectKind.MAGNET,
        lambda p, v, t: _along(-p, _pull_of_magnet(p)),
        {"stiffness": _STIFFNESS, "force": _FORCE, "radius": _RADIUS},
    ),
    "vibration": _Effect(
        EffectKind.VIBRATION,
        lambda p, v, t: np.outer(_FORCE * np.sin(2.0 * np.pi * _VIBRATION * t), _UPWARDS),
        {"force": _FORCE, "frequency": _VIBRATION, "direction": _UPWARDS},
    ),
    "stick slip": _Effect(EffectKind.STICK_SLIP, lambda p, v, t: _stuck(p), {"stiffness": _STIFFNESS, "slip": _SLIP}),
    "workspace": _Effect(
        EffectKind.WORKSPACE,
        lambda p, v, t: _along(-p, _STIFFNESS * (np.linalg.norm(p, axis=1) - _FREE)),
        {"stiffness": _STIFFNESS, "radius": _FREE},
    ),
    "force field": _Effect(
        EffectKind.FIELD,
        lambda p, v, t: _along(-p, _pull_of_well(p)),
        {"parameters": (_FORCE, _RADIUS, *(0.0,) * 6)},
    ),
}
"""Kinds of effects by the word of a scene file, and a force field."""


def _hands() -> F8:
    """Return the hand's record in each tick, on a circle about the effect's place, [ticks, INPUT_LENGTH]."""
    hands = np.zeros((_TICKS, INPUT_LENGTH))
    t = hands[:, INPUT_TIME] = _DT * np.arange(_TICKS)
    turn = 2.0 * np.pi * _RATE * t
    first, second = np.array([0.8, 0.6, 0.0]), np.array([-0.36, 0.48, 0.8])
    place = _CIRCLE * (np.outer(np.cos(turn), first) + np.outer(np.sin(turn), second))
    hands[:, INPUT_POSITION : INPUT_POSITION + 3] = place
    hands[:, INPUT_VELOCITY : INPUT_VELOCITY + 3] = np.gradient(place, _DT, axis=0)
    return hands


def _run_effect(name: str, enabled: int = 1) -> tuple[Callable[[], None], F8, F8]:
    """Return a function that runs all ticks with an effect, the hand's records, and the forces that it writes [N].

    Args:
        name: Name of the effect.
        enabled: 0 leaves the effect out.
    """
    spec, capacities = _EFFECTS[name], ObjectCapacities(shapes=1, bodies=1, effects=1, wires=1, paths=1)
    rows, work, counts = new_rows(capacities), new_object_work(capacities), np.zeros(1, OBJECT_COUNTS)
    row = rows.effects[0]
    row["kind"], row["enabled"], row["body"], row["path"] = spec.kind, 1, STATIC, -1
    for key, value in spec.values.items():
        row[key] = value
    build_tunnel(np.column_stack([np.linspace(-0.3, 0.3, 13), *np.zeros((2, 13))]), 0.02).fill(work.paths[0])
    counts["effects"] = enabled
    hands, forces = _hands(), np.zeros((_TICKS, 3))
    fields = (well, *NO_FIELDS[1:])
    return lambda: _act_often(rows, work, counts[0], hands, fields, forces), hands, forces


def _effect_us(name: str) -> float:
    """Return what a tick with the effect takes more than one without it [us]."""
    empty, run = _run_effect(name, enabled=0)[0], _run_effect(name)[0]
    return max(0.0, shortest_us(run, _TICKS, _RUNS) - shortest_us(empty, _TICKS, _RUNS))


def _effect_error(name: str) -> float:
    """Return the largest difference of the force from the law [N]."""
    run, hands, forces = _run_effect(name)
    run()
    place, velocity = hands[:, INPUT_POSITION : INPUT_POSITION + 3], hands[:, INPUT_VELOCITY : INPUT_VELOCITY + 3]
    expected = _EFFECTS[name].law(place, velocity, hands[:, INPUT_TIME])
    return float(np.linalg.norm(forces - expected, axis=1).max())


compare(
    __name__,
    "one effect or force field in a tick of a hand on a circle; error: difference from its law",
    "N",
    [
        Rival(
            name,
            f"kernels.objects.force_effects, {spec.kind.name}",
            "a hand anywhere",
            {"effect": name.replace(" ", "_")},
        )
        for name, spec in _EFFECTS.items()
    ],
    Probes(_effect_us, _effect_error, reference_us),
    default="spring",
    why_default="each is another force: none replaces another",
)
