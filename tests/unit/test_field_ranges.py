"""Every number that the loop reads has a physical range, asked at load, over a task's maps, and at each write."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.field_ranges import RANGES, SCENE_RANGES
from mimics_app.contracts.loop.haptic import LIMIT_NAMES, SCENE
from mimics_app.contracts.loop.object_rows import ROW_DTYPES, ObjectCapacities, new_rows
from mimics_app.rendering.haptic.block_check import check_values
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.tasks.check import check_task
from mimics_app.tasks.task import TaskSpec

NO_ENERGY = (
    "virtual_damping", "tunnel.damping", "tunnel.drag", "tunnel.drag_growth", "tunnel.stiffness", "tunnel.centring",
    "shapes.one.stiffness", "shapes.one.damping", "shapes.one.friction_dynamic", "shapes.one.friction_stiffness",
    "bodies.one.mass", "bodies.one.damping_translation", "bodies.one.damping_rotation", "effects.one.stiffness",
    "effects.one.damping", "tunnels.one.drag", "virtual_mass", "ball_radius_min", "grasp_force_full",
)  # fmt: skip
"""Below 0 each of them would push instead of resist, or be nothing physical."""

STRUCTURE = {"R_world_from_robot"}
"""Floats of SCENE with a rule of their own."""


def _store() -> ParameterStore:
    """One row in each table, called "one"."""
    block, rows = scene_from_components(), new_rows(ObjectCapacities())
    for table in rows._fields:
        block[0]["objects"][table] = 1
    rows.shapes[0]["orientation"], rows.shapes[0]["kind"], rows.shapes[0]["size"] = (0, 0, 0, 1), 1, (0.1, 0, 0)
    rows.shapes[0]["stiffness"], rows.shapes[0]["body"] = 100.0, -1
    rows.bodies[0]["mass"], rows.bodies[0]["orientation"] = 1.0, (0, 0, 0, 1)
    rows.tunnels[0]["stiffness"] = 1000.0
    names = {table: {"one": (0,)} for table in ("shapes", "bodies", "effects", "tunnels", "curves")}
    return ParameterStore(block, rows, names)


def _state(store: ParameterStore) -> tuple[Any, ...]:
    return store.block.tobytes(), *(table.tobytes() for table in store._rows)  # type: ignore[union-attr]


def _writable() -> list[tuple[str, Any]]:
    of_scene = [(name, each) for name, each in SCENE_RANGES.items() if each.written]
    own = [(f"tunnel.{name}", each) for name, each in RANGES["tunnels"].items() if each.written]
    rows = [
        (f"{table}.one.{name}", each)
        for table, fields in RANGES.items()
        for name, each in fields.items()
        if each.written
    ]
    return of_scene + own + rows


@pytest.mark.parametrize("table", ROW_DTYPES)
def test_every_number_of_a_row_has_a_range(table: str):
    dtype = ROW_DTYPES[table]
    floats = {name for name in dtype.names or () if dtype[name].base.kind == "f"}
    assert floats <= set(RANGES[table])
    assert set(RANGES[table]) <= set(dtype.names or ())
    for name, span in RANGES[table].items():
        assert span.least < span.most and math.isfinite(span.least) and math.isfinite(span.most), name


def test_every_number_of_the_block_is_a_limit_or_has_a_range():
    floats = {name for name in SCENE.names or () if SCENE[name].base.kind == "f"}
    assert floats - set(LIMIT_NAMES) - STRUCTURE == set(SCENE_RANGES)


@pytest.mark.parametrize("name", NO_ENERGY)
def test_what_would_give_energy_is_refused_in_a_map_and_in_a_write(name: str):
    parameter = {"default": 1.0, "min": 0.0, "max": 1.0, "maps": [{"to": f"haptic.{name}", "scale": -100.0}]}
    faults = check_task(msgspec.convert({"parameters": {"p": parameter}}, TaskSpec), "/task", "scene.json")
    assert [fault.pointer for fault in faults] == ["/task/parameters/p/maps/0/scale"]
    assert f"sets {name} to -100 to 0; it must be within" in faults[0].what
    store = _store()
    before = _state(store)
    with pytest.raises(UsageError, match="is refused: it must be within"):
        store.change({name: -1e-9})
    assert _state(store) == before


@pytest.mark.parametrize(("name", "span"), _writable())
def test_each_name_takes_both_of_its_ends_and_nothing_beyond(name: str, span: Any):
    store = _store()
    records, field = store._find(name)
    shape = np.shape(records[0][field])
    for beyond in (span.least - 1e-3 * max(1.0, abs(span.least)), 2.0 * span.most + 1.0, math.nan, math.inf, -math.inf):
        before = _state(store)
        for value in {beyond} if not shape else [np.append(np.zeros(shape[0] - 1), beyond)]:
            with pytest.raises(UsageError, match="is refused"):
                store.change({name: value})
        assert _state(store) == before
    taken = 0
    for end in (span.least, span.most):
        before = _state(store)
        try:
            store.change({name: np.full(shape, end)})
            taken += 1
        except UsageError as error:
            assert "cannot be set" in str(error), "refused only beside another number"
            assert _state(store) == before
        check_values(store.block, store._rows)
    assert taken > 0 or name.endswith("orientation")


@pytest.mark.parametrize(
    ("maps", "pointer"),
    [
        ([{"to": "haptic.tunnel.drag", "offset": -0.5}], "maps/0/scale"),
        ([{"to": "haptic.tunnel.drag", "table": [0.0, 2.0, -1e-6]}], "maps/0/table"),
        ([{"to": "visual.x"}, {"to": "haptic.tunnel.advance", "scale": 1e12}], "maps/1/scale"),
        ([{"to": "haptic.effects.snap.stiffness", "scale": 1e12}], "maps/0/scale"),
    ],
)
def test_the_whole_range_of_a_map_counts(maps: list[Any], pointer: str):
    parameter = {"default": 1.0, "min": 0.0, "max": 1.0, "step": 0.5, "maps": maps}
    faults = check_task(msgspec.convert({"parameters": {"p": parameter}}, TaskSpec), "/task", "scene.json")
    assert [fault.pointer for fault in faults] == [f"/task/parameters/p/{pointer}"]
