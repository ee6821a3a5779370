"""Shapes and points that the loop may not have are refused by name, at its door too."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
import pytest

from mimics_app.contracts.loop.bounded_fields import choice_of, largest_values, record
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.haptic_objects import ForceLaw, ShapeKind
from mimics_app.contracts.loop.object_rows import ROW_DTYPES, ObjectCapacities, new_rows
from mimics_app.rendering.haptic.block_check import check_block
from mimics_app.rendering.haptic.row_checks import check_points, check_shapes
from tests.support.touch_play import KINDS, SOLIDS, add_point, new_touch_play

FAULTS = [
    (ShapeKind.SPHERE, {"size": (0.0, 0.0, 0.0)}, "size"),
    (ShapeKind.BOX, {"size": (0.1, 0.0, 0.1)}, "size"),
    (ShapeKind.CAPSULE, {"size": (0.1, -0.1, 0.0)}, "size"),
    (ShapeKind.BOX, {"rounding": 0.021}, "rounding"),
    (ShapeKind.CYLINDER, {"rounding": -0.001}, "rounding"),
    (ShapeKind.BOX, {"orientation": (0.0, 0.0, 0.0, 2.0)}, "orientation"),
    (ShapeKind.WALL, {"stiffness": 0.0}, "stiffness"),
    (ShapeKind.WALL, {"damping": -1.0}, "damping"),
    (ShapeKind.WALL, {"law": ForceLaw.HUNT_CROSSLEY, "exponent": 0.5}, "exponent"),
    (ShapeKind.WALL, {"friction_static": 0.2, "friction_dynamic": 0.3}, "friction_dynamic"),
    (ShapeKind.WALL, {"friction_stiffness": -1.0}, "friction_stiffness"),
    (ShapeKind.WALL, {"texture_height": 1e-3, "texture_length": 1e-3}, "texture_height"),
]


def test_good_rows_pass():
    play = new_touch_play()
    for kind in KINDS:
        play.add_shape(kind, SOLIDS.get(kind, ()))
    add_point(play)
    check_shapes(play.rows.shapes[: len(KINDS)])
    check_points(play.rows.points)


@pytest.mark.parametrize("kind, fields, reported", FAULTS)
def test_bad_shapes_are_named(kind, fields, reported):
    play = new_touch_play()
    play.add_shape(ShapeKind.WALL, ())
    play.add_shape(kind, SOLIDS.get(kind, ()))
    for name, value in fields.items():
        play.rows.shapes[1][name] = value
    with pytest.raises(ValueError, match=rf"shapes\[1\]\.{reported}"):
        check_shapes(play.rows.shapes[:2])


def test_the_door_of_the_loop_asks():
    play = new_touch_play()
    play.add_shape(ShapeKind.MESH, ())
    add_point(play)
    scene = np.zeros(1, SCENE)
    scene["sequence"], scene["virtual_mass"], scene["objects"] = 1, 1.0, play.counts[0]
    check_block(scene, play.rows, ObjectCapacities(), meshes=1)
    with pytest.raises(ValueError, match=r"shapes\.mesh is 0"):
        check_block(scene, play.rows, ObjectCapacities(), meshes=0)
    scene["force_limit"] = -1.0
    with pytest.raises(ValueError, match=r"force_limit is -1.0"):
        check_block(scene, play.rows, ObjectCapacities(), meshes=1)
    scene["force_limit"] = 0.0
    scene["R_world_from_robot"] = 2.0 * np.eye(3)
    with pytest.raises(ValueError, match=r"R_world_from_robot"):
        check_block(scene, play.rows, ObjectCapacities(), meshes=1)
    scene["R_world_from_robot"] = np.eye(3)
    play.rows.points[0]["radius"] = -0.001
    with pytest.raises(ValueError, match=r"points\[0\]\.radius"):
        check_block(scene, play.rows, ObjectCapacities(), meshes=1)


CHOICES = [(table, field) for table, dtype in ROW_DTYPES.items() for field in largest_values(dtype)]


@pytest.mark.parametrize(("table", "field"), CHOICES)
def test_a_choice_that_no_kernel_knows_is_refused(table: str, field: str) -> None:
    rows, scene = new_rows(ObjectCapacities()), np.zeros(1, SCENE)
    scene["sequence"], scene["objects"][table] = 1, 1
    getattr(rows, table)[field][0] = largest_values(ROW_DTYPES[table])[field] + 1
    with pytest.raises(ValueError, match=rf"^{table}\.{field} is"):
        check_block(scene, rows, ObjectCapacities())


def test_the_bound_of_a_choice_is_its_newest_member() -> None:
    newer = IntEnum("newer", "FIRST SECOND THIRD", start=0)
    assert dict(largest_values(record([("kind", choice_of(newer)), ("size", "f8", (3,))]))) == {"kind": 2}
