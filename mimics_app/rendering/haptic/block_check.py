"""Validation of parameter blocks before the loop reads them: compiled code checks neither indices nor signs."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.loop.bounded_fields import largest_values
from mimics_app.contracts.loop.field_ranges import RANGES, SCENE_RANGES, Range
from mimics_app.contracts.loop.haptic import LIMIT_NAMES, SCENE
from mimics_app.contracts.loop.haptic_objects import STATIC, ShapeKind
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, count_rows
from mimics_app.rendering.haptic.row_checks import check_points, check_shapes

__all__ = ["check_block", "check_values"]


_NOT_NEGATIVE = sorted(LIMIT_NAMES - {"joint_min", "joint_max"})
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
        ValueError: A choice, count or row is out of range, `sequence` is not positive, or `check_values` refuses a
            number.
    """
    if int(scene[0]["sequence"]) < 1:
        raise ValueError("SCENE.sequence must count up from 1")
    for name, largest in largest_values(scene.dtype).items():
        _check_column(f"SCENE.{name}", np.ravel(scene[0][name]), 0, largest)
    _check_rows(scene[0]["objects"], rows, capacities)
    _check_whole("SCENE.own_tunnel", int(scene[0]["own_tunnel"]), 0, max(0, int(scene[0]["objects"]["tunnels"]) - 1))
    check_values(scene, rows)
    if rows is not None:
        shapes = rows.shapes[: scene[0]["objects"]["shapes"]]
        of_mesh = shapes["mesh"][shapes["kind"] == ShapeKind.MESH]
        _check_column("shapes.mesh", of_mesh, 0, meshes - 1)


def check_values(scene: Records, rows: Rows | None) -> None:
    """Refuse numbers of a block that are not physical; its counts, choices and references are right.

    The same check holds for a scene that is read, for a run that begins, and for every value that is written later.

    Args:
        scene: SCENE record, shape [1].
        rows: Tables of objects that the record counts; None where it counts none.

    Raises:
        ValueError: A number is not finite, a limit negative, a number outside its range, a rotation none, a shape
            without size, or a surface that would add energy.
    """
    _check_scene(scene[0])
    if rows is None:
        return
    used = count_rows(scene[0]["objects"])
    check_shapes(rows.shapes[: used["shapes"]])
    check_points(rows.points[: used["points"]])
    for table in (table for table, count in used.items() if count):
        for name, span in RANGES[table].items():
            _check_range_of_rows(f"{table}[{{}}].{name}", getattr(rows, table)[name][: used[table]], span)


def _check_scene(record: np.void) -> None:
    for name in _float_fields(SCENE):
        if not np.all(np.isfinite(record[name])):
            raise ValueError(f"SCENE.{name} is not finite")
    for name in _NOT_NEGATIVE:
        if np.any(record[name] < 0):
            raise ValueError(f"SCENE.{name} is {record[name]}; it must not be negative")
    for name, span in SCENE_RANGES.items():
        _check_range(f"SCENE.{name}", record[name], span)
    if record["ball_radius_min"] > record["ball_radius_max"]:
        raise ValueError(f"SCENE.ball_radius_min is {record['ball_radius_min']}; it must not be above ball_radius_max")
    if np.linalg.norm(record["R_world_from_robot"], 2) > 1.0 + _ROTATION_TOLERANCE:
        raise ValueError("SCENE.R_world_from_robot is not a rotation: it would amplify forces")


def _check_range_of_rows(name: str, column: Records, span: Range) -> None:
    good = ((column >= span.least) & (column <= span.most)).reshape(len(column), -1).all(axis=1)
    if not good.all():
        row = int(good.argmin())
        _check_range(name.format(row), column[row], span)


def _check_range(name: str, value: Records, span: Range) -> None:
    if not span.holds(value):
        raise ValueError(f"{name} is {value}; it must be {span}")


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
    for name in ("points", "effects", "tunnels"):
        _check_column(f"{name}.contact", getattr(rows, name)["contact"][: used[name]], 0, MAX_CONTACTS - 1)
    wires = rows.wires[: used["wires"]]
    _check_column("shapes.body", rows.shapes["body"][: used["shapes"]], STATIC, last_body)
    _check_column("effects.body", rows.effects["body"][: used["effects"]], STATIC, last_body)
    _check_column("wires.source_row", wires["source_row"], 0, max(MAX_CONTACTS - 1, last_body))
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
    bad = (values < least) | (values > largest)
    if bad.any():
        _check_whole(name, int(values[bad.argmax()]), least, largest)


def _check_whole(name: str, value: int, least: int, largest: int) -> None:
    if not least <= value <= largest:
        raise ValueError(f"{name} is {value}; it must be within {least} and {largest}")


def _float_fields(dtype: np.dtype[Any]) -> list[str]:
    """Return the names of all float fields of a record type."""
    return [name for name in dtype.names or () if dtype[name].base.kind == "f"]
