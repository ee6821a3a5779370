"""Parameter blocks of older versions: with the only tunnel in them, for the HapticMaster, or without controllers."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead, Slot, TargetKind, name_bytes
from mimics_app.contracts.loop.haptic import SCENE, AdmittanceForm
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS
from mimics_app.contracts.loop.object_rows import ROW_DTYPES, Rows, count_rows

__all__ = ["OlderController", "current_block", "rows_with_tunnel"]


_TUNNEL = "tunnel"
"""Field of such a block that holds the tunnel."""

_NEW = {"own_tunnel", "objects"}
"""Fields of SCENE that such a block lacks, or that count one table fewer."""

_OFFSET = "axis_offset"
"""d1 of the HapticMaster [m], the geometry of blocks without a description of the device."""

_OF_DEVICES = {
    "joints": 3,
    "contacts": 1,
    "torques": 0,
    "polar": 1,
    "joint_inertia": 0.0,
    "joint_velocity": 1e9,  # not limited by joint [m/s, rad/s]
    "joint_acceleration": 1e9,
    "geometry": 0.0,
}
"""Values that such a block implies."""

_WITHOUT = {
    "late_latches": 1,
    "measured_force_limit": 1e9,
    "device_mass": 0.0,
    "device_lag": -1.0,
    "device_filter": 0.0,
    "drive_speed": 0.3,
    "device_quantum": 0.0,
    "reference_cadence": 0.0,
    "reference_speed": 0.0,
    "reference_amplitude": 0.0,
    "guidance": 0.0,
    "cadence_rate": 0.0,
    "speed_rate": 0.0,
    "amplitude_rate": 0.0,
    "guidance_rate": 0.0,
    "natural_step": 0.0,
    "longest_step": 0.0,
    "obstacle_calls": 0,
    "obstacle": 0,
}
"""Parameters that earlier versions lack, with the value of their behaviour: late ticks always latched, forces never,
the stability limit knew nothing of the device but its delay, a robot drove to a start at 0.3 m/s, no scene had a
reference of the joints, and nobody called an obstacle."""

_WIDER = {"target", "joint_min", "joint_max"}
"""Vectors that had three joints, or one point."""


class OlderController(IntEnum):
    """SCENE.controller before controllers were plug-ins in slots."""

    OFF = 0
    JOINT_PD = 1
    WORLD_PD = 2
    ADMITTANCE = 3
    IMPEDANCE = 4


_CHOICES = {"form", "kp", "kd", "through_joints"}
"""Fields that chose and set controllers then."""

_SLOTS = {
    "controller_names",
    "leads",
    "commands",
    "targets",
    "each_joint",
    "controller_parameters",
    "drive_rate",
}
"""Fields that do so now."""

_SLOT_OF = {
    OlderController.OFF: Slot.OFF,
    OlderController.JOINT_PD: Slot.HOLD,
    OlderController.WORLD_PD: Slot.START,
    OlderController.ADMITTANCE: Slot.PERSON,
    OlderController.IMPEDANCE: Slot.PERSON,
}


def rows_with_tunnel(record: Records, rows: Rows | None) -> Rows | None:
    """Return the tables of a block, with the tunnel that an older version wrote into the block itself.

    Args:
        record: Shape [1], with the dtype of the version that wrote it.
        rows: Its tables, None where that version had none.

    Returns:
        The tables with this version's columns; those that the version lacks are 0: points belong to the first point of
        contact, tunnels have the rotation-minimising frame.
    """
    names = record.dtype.names or ()
    if _TUNNEL not in names or "pieces" not in (record.dtype[_TUNNEL].names or ()):
        return rows if rows is None else _rows_as_now(rows)
    others = rows or Rows(*(np.zeros(0, dtype) for dtype in ROW_DTYPES.values()))
    return _rows_as_now(others._replace(tunnels=record[_TUNNEL][record[_TUNNEL]["pieces"] > 0].copy()))


def _rows_as_now(rows: Rows) -> Rows:
    return Rows(**{name: _as_now(table, ROW_DTYPES[name]) for name, table in rows._asdict().items()})


def current_block(record: Records, rows: Rows | None) -> Records | None:
    """Return a block as this version's SCENE record, shape [1]; None where its fields differ or are missing.

    Args:
        record: Shape [1], with the dtype of the version that wrote it.
        rows: Result of `rows_with_tunnel`.
    """
    if record.dtype == SCENE:
        return record
    if (widened := _with_all_parameters(record)) is not None:
        return widened
    block = _of_a_device(record)
    old = set(record.dtype.names or ())
    kept = [name for name in SCENE.names or () if name not in _NEW | _WIDER | _SLOTS | {*_OF_DEVICES}]
    stated = old - {_TUNNEL, _OFFSET, *_NEW, *_WIDER, *_CHOICES, *_OF_DEVICES}
    same = stated | set(_WITHOUT) == set(kept) and all(record.dtype[name] == SCENE[name] for name in stated)
    if block is None or not same or rows is None:
        return None
    if any(table.dtype != ROW_DTYPES[name] for name, table in rows._asdict().items()):
        return None
    for name in kept:
        block[name] = record[name] if name in stated else _WITHOUT[name]
    _fill_slots(record, block)
    if "objects" in old:
        counts = record["objects"][0]
        for name in set(counts.dtype.names or ()) & {*(OBJECT_COUNTS.names or ())}:
            block["objects"][name] = counts[name]
    block["objects"]["tunnels"] = len(rows.tunnels)
    return block if count_rows(block[0]["objects"]) == {name: len(t) for name, t in rows._asdict().items()} else None


def _with_all_parameters(record: Records) -> Records | None:
    """Return a block whose controllers had fewer parameters as this version's, shape [1]; None for any other."""
    names, last = SCENE.names or (), "controller_parameters"
    if record.dtype.names != names or any(record.dtype[name] != SCENE[name] for name in names if name != last):
        return None
    slots, width = record.dtype[last].shape
    if not (slots == SCENE[last].shape[0] and width <= SCENE[last].shape[1]):
        return None
    block = np.zeros(1, SCENE)
    for name in names:
        (block[name][:, :, :width] if name == last else block[name])[:] = record[name]
    return block


def _of_a_device(record: Records) -> Records | None:
    """Return a SCENE record, shape [1], with the device's fields of a block; None where they are ambiguous."""
    old, block = set(record.dtype.names or ()), np.zeros(1, SCENE)
    if not old >= _WIDER | {"form", "kp", "kd"}:
        return None
    for name in _WIDER:
        width = record.dtype[name].shape[0] if record.dtype[name].shape else 0
        if not 0 < width <= SCENE[name].shape[0]:
            return None
        block[name][:, :width] = record[name]
    if _OFFSET not in old:
        for name in _OF_DEVICES:
            if name not in old or record.dtype[name] != SCENE[name]:
                return None
            block[name] = record[name]
        return block
    for name, value in _OF_DEVICES.items():
        block[name] = value
    block["geometry"][:, 0] = record[_OFFSET]
    return block


def _fill_slots(record: Records, block: Records) -> None:
    """Write the controllers that a block without slots chose among into those of a SCENE record, shape [1]."""
    printed = int(record["form"][0]) == AdmittanceForm.SEED
    through = bool(record["through_joints"][0]) if "through_joints" in (record.dtype.names or ()) else printed
    polar, driven = bool(block["polar"][0]), bool(record["force_driven"][0])
    form = AdmittanceForm(int(record["form"][0])).name.lower() if polar else "joints"
    names = {
        Slot.HOLD: "joint_pd",
        Slot.START: "world_pd_joints" if through else "world_pd_straight",
        Slot.PERSON: "impedance" if driven else f"admittance_{form}",
    }
    for slot, name in names.items():
        block["controller_names"][0][slot] = name_bytes(name)
    slots = block[0]
    slots["controller"] = _SLOT_OF[OlderController(int(record["controller"][0]))]
    slots["leads"][[Slot.HOLD, Slot.START, Slot.PERSON]] = Lead.TARGET, Lead.TARGET, Lead.PERSON
    slots["targets"][Slot.START] = TargetKind.POINTS
    slots["commands"][Slot.PERSON] = CommandKind.FORCE if driven else CommandKind.VELOCITY
    slots["each_joint"][Slot.PERSON] = polar and printed and not driven
    width, joints = record["kp"].shape[1], block["joint_min"].shape[1]
    for slot in (Slot.HOLD, Slot.START):
        slots["controller_parameters"][slot, :width] = record["kp"][0]
        slots["controller_parameters"][slot, joints : joints + width] = record["kd"][0]
    slots["drive_rate"] = record["kp"][0][:3].max()


def _as_now(table: Records, wanted: np.dtype[Any]) -> Records:
    """Return rows of an older version with this version's columns, 0 where missing; unchanged where one differs."""
    old = table.dtype.names or ()
    if any(name not in (wanted.names or ()) or table.dtype[name] != wanted[name] for name in old):
        return table
    rows = np.zeros(len(table), wanted)
    for name in old:
        rows[name] = table[name]
    return rows
