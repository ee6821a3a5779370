"""A few effects, bodies and wires without a scene, driven tick by tick."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.function_pointers import functions_at, pointers_to
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import (
    BODY,
    EFFECT,
    OBJECT_COUNTS,
    POINT,
    SHAPE,
    STATIC,
    TUNNEL,
    WIRE,
    BodyFlag,
)
from mimics_app.contracts.loop.loop_ports import FIELDS, MAX_FIELDS
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows
from mimics_app.contracts.loop.reference_rows import CURVE
from mimics_app.rendering.haptic.kernels.objects.force_effects import apply_effects
from mimics_app.rendering.haptic.kernels.objects.object_inputs import (
    INPUT_FORCE_MEASURED,
    INPUT_FORCE_USER,
    INPUT_GRASP,
    INPUT_LENGTH,
    INPUT_POSITION,
    INPUT_TIME,
    INPUT_VELOCITY,
)
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.kernels.objects.wires import carry_signals
from mimics_app.rendering.haptic.no_objects import no_field
from mimics_app.rendering.haptic.objects import new_object_work

ALL = BodyFlag.TRANSLATION | BodyFlag.ROTATION | BodyFlag.FORCE_ON_OBJECT | BodyFlag.TORQUE_ON_OBJECT


@kernel
def _carry(rows: Any, work: Any, counts: Any, hand: Any) -> None:
    carry_signals(borrowed(rows), borrowed(work), counts, hand)


@kernel
def _act(rows: Any, work: Any, counts: Any, hand: Any, pointers: Any) -> None:
    apply_effects(borrowed(rows), borrowed(work), counts, hand, functions_at(pointers, FIELDS))


def effect(kind: int, **values: Any) -> np.ndarray:
    """One enabled EFFECT row on the user alone."""
    row = np.zeros(1, EFFECT)
    row["kind"], row["enabled"], row["body"], row["path"] = kind, 1, STATIC, -1
    for name, value in values.items():
        row[name] = value
    return row


def wire(source: int, target: int, *, of: int = 0, to: int = 0, gain: Any = 1.0, offset: Any = 0.0) -> np.ndarray:
    """One WIRE row."""
    row = np.zeros(1, WIRE)
    row["source"], row["source_row"], row["target"], row["target_row"] = source, of, target, to
    row["gain"] = gain if np.ndim(gain) == 2 else gain * np.eye(3)
    row["offset"] = offset
    return row


class Bench:
    """Rows, working arrays, and a hand.

    Args:
        effects: EFFECT rows.
        bodies: How many bodies; they are placed at the origin.
        wires: WIRE rows.
        paths: TUNNEL records.
        fields: Force fields.
    """

    def __init__(
        self, *effects: np.ndarray, bodies: int = 0, wires: Any = (), paths: Any = (), fields: Any = ()
    ) -> None:
        table = np.zeros(bodies, BODY)
        table["flags"], table["mass"] = ALL, 1.0
        self.rows = Rows(
            shapes=np.zeros(0, SHAPE),
            bodies=table,
            effects=np.concatenate(effects) if effects else np.zeros(0, EFFECT),
            points=np.zeros(1, POINT),
            wires=np.concatenate(wires) if wires else np.zeros(0, WIRE),
            tunnels=np.zeros(0, TUNNEL),
            curves=np.zeros(0, CURVE),
        )
        self.work = new_object_work(ObjectCapacities(effects=max(1, len(effects)), bodies=max(1, bodies)))
        self.work.paths[: len(paths)] = np.concatenate(paths) if paths else 0
        for motion in self.work.motions[:bodies]:
            motion["orientation"], motion["rotation"] = (0, 0, 0, 1), np.eye(3)
        self.counts = np.zeros(1, OBJECT_COUNTS)
        for name, rows in self.rows._asdict().items():
            self.counts[0][name] = len(rows)
        self.hand = np.zeros(INPUT_LENGTH)
        self.fields = (*fields, *[no_field] * (MAX_FIELDS - len(fields)))
        self._pointers = pointers_to(self.fields, FIELDS)

    @property
    def totals(self) -> Any:
        return self.work.totals[0]

    @property
    def motions(self) -> Any:
        return self.work.motions

    def set_hand(self, **values: Any) -> None:
        """Set what the objects see of the person: p, v, measured, felt, grasp, t."""
        places = {"p": INPUT_POSITION, "v": INPUT_VELOCITY, "measured": INPUT_FORCE_MEASURED, "felt": INPUT_FORCE_USER}
        for name, value in values.items():
            if name in places:
                self.hand[places[name] : places[name] + 3] = value
            else:
                self.hand[INPUT_GRASP if name == "grasp" else INPUT_TIME] = value

    def carry(self) -> None:
        _carry(self.rows, self.work, self.counts[0], self.hand)

    def force(self, p: Any = (0.0, 0.0, 0.0), v: Any = (0.0, 0.0, 0.0), t: float = 0.0, **more: Any) -> np.ndarray:
        """Force on the user [N] at one place and velocity, after one tick."""
        self.set_hand(p=p, v=v, t=t, **more)
        clear_totals(self.totals)
        for motion in self.work.motions:
            motion["force"], motion["torque"], motion["force_user"] = 0.0, 0.0, 0.0
        self.carry()
        _act(self.rows, self.work, self.counts[0], self.hand, self._pointers)
        return np.array(self.totals["effect_force"])
