"""Rows that the loop may not have are refused by name."""

from __future__ import annotations

import math

import pytest

from mimics_app.contracts.haptic_objects import ForceLaw, ShapeKind
from mimics_app.rendering.haptic.row_checks import check_rows
from tests.support.touch_play import KINDS, SOLIDS, add_point, new_touch_play

FAULTS = [
    (ShapeKind.SPHERE, {"size": (0.0, 0.0, 0.0)}, "size"),
    (ShapeKind.BOX, {"size": (0.1, 0.0, 0.1)}, "size"),
    (ShapeKind.CAPSULE, {"size": (0.1, -0.1, 0.0)}, "size"),
    (ShapeKind.CYLINDER, {"size": (math.nan, 0.1, 0.0)}, "not finite"),
    (ShapeKind.BOX, {"rounding": 0.021}, "rounding"),
    (ShapeKind.CYLINDER, {"rounding": -0.001}, "rounding"),
    (ShapeKind.MESH, {"mesh": 1}, "no mesh 1 of 1"),
    (ShapeKind.BOX, {"body": 0}, "no body"),
    (ShapeKind.BOX, {"kind": 9}, "no kind"),
    (ShapeKind.BOX, {"orientation": (0.0, 0.0, 0.0, 2.0)}, "unit quaternion"),
    (ShapeKind.WALL, {"stiffness": 0.0}, "stiffness"),
    (ShapeKind.WALL, {"damping": -1.0}, "damping"),
    (ShapeKind.WALL, {"law": ForceLaw.HUNT_CROSSLEY, "exponent": 0.5}, "exponent"),
    (ShapeKind.WALL, {"law": 7}, "no law"),
    (ShapeKind.WALL, {"friction_static": 0.2, "friction_dynamic": 0.3}, "friction"),
    (ShapeKind.WALL, {"friction_stiffness": -1.0}, "friction_stiffness"),
    (ShapeKind.WALL, {"texture_height": 1e-3, "texture_length": 1e-3}, "steeper"),
]


def test_good_rows_pass():
    play = new_touch_play()
    for kind in KINDS:
        play.add_shape(kind, SOLIDS.get(kind, ()))
    add_point(play)
    check_rows(play.rows, play.counts[0], meshes=1)


@pytest.mark.parametrize("kind, fields, told", FAULTS)
def test_bad_shapes_are_named(kind, fields, told):
    play = new_touch_play()
    play.add_shape(ShapeKind.WALL, ())
    play.add_shape(kind, SOLIDS.get(kind, ()))
    for name, value in fields.items():
        play.rows.shapes[1][name] = value
    with pytest.raises(ValueError, match=f"shape 1: .*{told}"):
        check_rows(play.rows, play.counts[0], meshes=1)


def test_bad_points_and_counts_are_named():
    play = new_touch_play()
    add_point(play, radius=-0.001)
    with pytest.raises(ValueError, match="point 0"):
        check_rows(play.rows, play.counts[0])
    play.rows.points[0]["radius"] = 0.0
    play.counts[0]["shapes"] = 1000
    with pytest.raises(ValueError, match="1000 shapes"):
        check_rows(play.rows, play.counts[0])
