"""Validation of parameter blocks before the loop reads them: compiled code checks neither indices nor signs."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.bounded_fields import largest_values
from mimics_app.contracts.haptic import FEEL, LIMIT_NAMES
from mimics_app.contracts.haptic_objects import STATIC
from mimics_app.contracts.loop_fields import MAX_CONTACTS
from mimics_app.contracts.object_rows import ObjectCapacities, Rows, count_rows
from mimics_app.rendering.haptic.row_checks import check_points, check_shapes

__all__ = ["check_block"]


_NOT_NEGATIVE = (*sorted(LIMIT_NAMES - {"joint_min", "joint_max"}), *(name for name, _ in FEEL))
"""Fields of SCENE that must be 0 or more: a negative limit would reverse a force."""

_ROTATION_TOLERANCE = 1e-3
"""Largest excess of a rotation's norm over 1."""


def check_block(scene: Records, rows: Rows | None, capacities: ObjectCapacities, meshes: int = 0) -> None:
    """Refuse a parameter block that the loop cannot run with.

    Args:
        scene: SCENE record, shape [1].
        rows: Tables of objects that the record counts; None where it counts none.
        capacities: Capacities of the tables.
        meshes: Number of meshes that shapes may refer to.

    Raises:
        ValueError: A number is not finite, a limit negative, a choice, count or row out of range, a rotation none, a
            shape without size, a surface with negative damping, or `sequence` is not positive.
    """
    if int(scene[0]["sequence"]) < 1:
        raise ValueError("SCENE.sequence must count up from 1")
    for name, largest in largest_values(scene.dtype).items():
        _check_whole(f"SCENE.{name}", int(scene[0][name]), 0, largest)
    for name in _float_fields(scene.dtype):
        if not np.all(np.isfinite(scene[0][name])):
            raise ValueError(f"SCENE.{name} is not finite")
    for name in _NOT_NEGATIVE:
        if np.any(scene[0][name] < 0):
            raise ValueError(f"SCENE.{name} is {scene[0][name]}; it must not be negative")
    if np.linalg.norm(scene[0]["R_world_from_robot"], 2) > 1.0 + _ROTATION_TOLERANCE:
        raise ValueError("SCENE.R_world_from_robot is not a rotation: it would amplify forces")
    _check_rows(scene[0]["objects"], rows, capacities)
    _check_whole("SCENE.own_tunnel", int(scene[0]["own_tunnel"]), 0, max(0, int(scene[0]["objects"]["tunnels"]) - 1))
    if rows is not None:
        check_shapes(rows.shapes[: scene[0]["objects"]["shapes"]], meshes)
        check_points(rows.points[: scene[0]["objects"]["points"]])


def _check_rows(counts: np.void, rows: Rows | None, capacities: ObjectCapacities) -> None:
    used = count_rows(counts)
    for name, count in used.items():
        table: Records = np.zeros(0) if rows is None else getattr(rows, name)
        _check_whole(f"SCENE.objects.{name}", count, 0, min(getattr(capacities, name), len(table)))
        if count:
            _check_table(name, table[:count])
    if rows is None:
        return
    last_body, last_effect = used["bodies"] - 1, used["effects"] - 1
    _check_column("points.contact", rows.points["contact"][: used["points"]], 0, MAX_CONTACTS - 1)
    wires = rows.wires[: used["wires"]]
    _check_column("shapes.body", rows.shapes["body"][: used["shapes"]], STATIC, last_body)
    _check_column("effects.body", rows.effects["body"][: used["effects"]], STATIC, last_body)
    _check_column("wires.source_row", wires["source_row"], 0, max(0, last_body))
    _check_column("wires.target_row", wires["target_row"], 0, max(0, last_body, last_effect))


def _check_table(name: str, table: Records) -> None:
    """Refuse a table with a choice out of range or a number that is not finite."""
    for field, largest in largest_values(table.dtype).items():
        _check_column(f"{name}.{field}", table[field], 0, largest)
    for field in _float_fields(table.dtype):
        bad = ~np.isfinite(table[field]).reshape(len(table), -1).all(axis=1)
        if bad.any():
            raise ValueError(f"{name}[{int(bad.argmax())}].{field} is not finite")


def _check_column(name: str, values: Records, least: int, largest: int) -> None:
    for value in values:
        _check_whole(name, int(value), least, largest)


def _check_whole(name: str, value: int, least: int, largest: int) -> None:
    if not least <= value <= largest:
        raise ValueError(f"{name} is {value}; it must be within {least} and {largest}")


def _float_fields(dtype: np.dtype[Any]) -> list[str]:
    """Return the names of all float fields of a record type."""
    return [name for name in dtype.names or () if dtype[name].base.kind == "f"]
