"""`mimics bench haptic`: cost of touching shapes, meshes and bodies, relative to a reference loop and to peers.

Every row is one workload: cull, narrow phase, force and friction of one tick for shapes and meshes; collisions and
motion for bodies. `us` is the cost in the compiled loop of the product; `ratio` is relative to 1000 sphere tests timed
in the same run; `tick_p99_us` is the 99th percentile of the duration of the whole tick in the live loop with that
scene, simulated robot and person included.

Where a peer is measured beside bodies in the same run, `us_from_python` is the same work of this program called tick by
tick from Python as the peer is: the same motion of the HIP, as many rounds, the shortest of them. Peers that are not
installed are listed as not measured.

`points` is the processor time of a tick with one, two and four points of contact, each in contact with its own object.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import types
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, STATIC, BodyFlag, ShapeKind
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.lab.haptic.body_worlds import heap_of_boxes
from mimics_app.lab.haptic.points_bench import measure_points
from mimics_app.lab.haptic.touch_probe import DT, RADIUS, STIFFNESS, touch_scene
from mimics_app.lab.haptic_harness import HarnessRow, run_harnesses
from mimics_app.lab.haptic_peers import PEERS, ROUNDS, best_us, measure_peer
from mimics_app.lab.probe import shortest_us
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.kernels.objects.object_inputs import INPUT_FORCE_MEASURED, INPUT_LENGTH
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.no_objects import NO_FIELDS
from mimics_app.rendering.haptic.objects import SIMULATE, ObjectWork, new_object_work
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.simulate import simulate_objects
from mimics_app.world.components.robot import Patient, Robot

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Fields, ObjectCountsRecord, ObjectWork, Rows, Simulate

__all__ = ["BODY_WORKLOADS", "SLIDE", "Scene", "measure_haptic", "reference_us"]

Step = Callable[[str], None]

_SHAPES = {
    "sphere": ShapeKind.SPHERE,
    "box": ShapeKind.BOX,
    "cylinder": ShapeKind.CYLINDER,
    "capsule": ShapeKind.CAPSULE,
}
_COUNTS = (1, 10, 100, 1000, 10_000)
_TRIANGLES = (100, 1000, 10_000, 100_000, 1_000_000)
_BODIES = (1, 10, 100, 1000)
_MIXED, _MOVING = 100, 10
_HEAPS = (10, 100)
_HEAP_TICKS = 4000
_SPHERES = 1000
_LIVE_S = 2.5
_MASS = 0.2
_GAP = 0.02
_DAMPING = 5.0
_PRESSED = 4e-3
"""Initial penetration of the HIP into its body [m]; the body sinks 2 mm into the floor under its weight."""

_PHASE = 2.0 * np.pi * np.arange(1000) / 1000
SLIDE = 4e-3 * np.sin(_PHASE)
"""Displacement of the HIP along x at each tick, repeated [m]: 4 mm to either side once a second, shape [1000]."""

_SLIDE_VELOCITY = 4e-3 * 2.0 * np.pi * np.cos(_PHASE)
"""Velocity of the HIP along x [m/s], shape [1000]."""

_VIA_POINTS = np.array([[0.0, 0.0, 0.0], [0.05, 0.0, 0.0]])
"""Path of the simulated person [m]."""

_CREEP = 1e-9
"""Step of the point from call to call [m], so that the compiler cannot hoist work out of the loop."""


@kernel
def _test_spheres(centres: F8, p: F8, calls: int) -> float:
    """Sum the depth of a point in each of many spheres, `calls` times: the reference loop."""
    total = 0.0
    for _ in range(calls):
        for i in range(centres.shape[0]):
            x, y, z = p[0] - centres[i, 0], p[1] - centres[i, 1], p[2] - centres[i, 2]
            total += max(0.0, RADIUS - np.sqrt(x * x + y * y + z * z))
        p[0] += _CREEP
    return total


def reference_us() -> float:
    """Return the cost of 1000 sphere tests [us]."""
    centres, p = np.random.default_rng(1).uniform(-0.5, 0.5, (_SPHERES, 3)), np.zeros(3)
    return shortest_us(lambda: _test_spheres(centres, p, 1000), 1000, ROUNDS)


@dataclass(frozen=True)
class _Row:
    """A row of the result."""

    work: str
    n: int
    us: float
    ratio: float
    tick_p99_us: float
    us_from_python: float | None = None
    peer: str | None = None
    peer_us: float | None = None

    def figures(self) -> dict[str, Any]:
        """Return the measured values by name."""
        return {name: value for name, value in asdict(self).items() if value is not None}


@dataclass(frozen=True, eq=False)
class Scene:
    """Haptic objects of a workload.

    Attributes:
        rows: Tables of objects.
        counts: OBJECT_COUNTS, shape [1].
        capacities: Capacities of the tables.
        hand: HIP in contact with one of them [m], shape [3].
        meshes: Triangles by SHAPE.mesh.
    """

    rows: Rows
    counts: NDArray[Any]
    capacities: ObjectCapacities
    hand: F8
    meshes: MeshTable = field(default_factory=build_mesh_table)

    def fresh_work(self) -> ObjectWork:
        """Return new working memory of the loop for them."""
        return new_object_work(self.capacities, self.meshes)


@typed_kernel(
    types.void(types.FunctionType(SIMULATE), *SIMULATE.args[:5], types.float64[:, ::1], types.int64, types.int64)
)
def _simulate_often(
    simulate: Simulate,
    rows: Rows,
    work: ObjectWork,
    counts: ObjectCountsRecord,
    hand: F8,
    fields: Fields,
    path: F8,
    first: int,
    ticks: int,
) -> None:
    force = np.zeros(3 * MAX_CONTACTS)
    for tick in range(first, first + ticks):
        for i in range(path.shape[1]):
            hand[i] = path[tick % path.shape[0], i]
        simulate(rows, work, counts, hand, fields, DT, force)


class _Hand:
    """A workload with a HIP that slides along x, tick by tick."""

    def __init__(self, scene: Scene) -> None:
        self._way = np.zeros((len(SLIDE), INPUT_FORCE_MEASURED))
        self._way[:, :3] = scene.hand
        self._way[:, 0] += SLIDE
        self._way[:, 3] = _SLIDE_VELOCITY
        self._hand = np.zeros(INPUT_LENGTH)
        self._args = (scene.rows, scene.fresh_work(), scene.counts[0], self._hand, NO_FIELDS)
        self._force = np.zeros(3 * MAX_CONTACTS)
        self._ticks = 0

    def run(self, ticks: int) -> None:
        """Run ticks in one compiled call, as the loop does."""
        _simulate_often(simulate_objects, *self._args, self._way, self._ticks, ticks)
        self._ticks += ticks

    def run_from_python(self, ticks: int) -> None:
        """Run ticks call by call from Python, as those of a peer."""
        for _ in range(ticks):
            self._hand[:INPUT_FORCE_MEASURED] = self._way[self._ticks % len(self._way)]
            simulate_objects(*self._args, DT, self._force)
            self._ticks += 1


def bodies_on_a_floor(kind: ShapeKind, count: int, fixed: int = 0) -> Scene:
    """Return free bodies of 0.2 kg and 4 cm at rest on a floor, awake, with the HIP pressed into one: the peers' scene.

    Args:
        kind: Kind of their shapes.
        count: Number of moving bodies.
        fixed: Number of static shapes of the same kind beside them.
    """
    capacities = ObjectCapacities(shapes=count + fixed + 1, bodies=count)
    rows, counts = new_rows(capacities), np.zeros(1, OBJECT_COUNTS)
    shapes, bodies = rows.shapes, rows.bodies
    places = _places_on_a_floor(count + fixed)
    shapes["enabled"], shapes["orientation"][:, 3], shapes["exponent"] = 1, 1.0, 1.0
    shapes["stiffness"], shapes["damping"] = STIFFNESS, _DAMPING
    shapes["friction_static"], shapes["friction_dynamic"] = 0.5, 0.4
    shapes["kind"], shapes["body"][:count], shapes["body"][count:] = kind, np.arange(count), STATIC
    shapes["position"][count : count + fixed] = places[count:]
    shapes["size"] = {ShapeKind.BOX: (2 * RADIUS,) * 3, ShapeKind.CYLINDER: (RADIUS, 2 * RADIUS, 0.0)}.get(
        kind, (RADIUS, 0.0, 0.0)
    )
    shapes["kind"][-1], shapes["orientation"][-1] = ShapeKind.WALL, (-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    bodies["flags"] = BodyFlag.TRANSLATION | BodyFlag.ROTATION | BodyFlag.FORCE_ON_OBJECT | BodyFlag.TORQUE_ON_OBJECT
    bodies["spawn"], bodies["mass"], bodies["orientation"][:, 3] = 1, _MASS, 1.0
    bodies["inertia"] = np.eye(3) * _MASS * (2 * RADIUS) ** 2 / 6.0
    bodies["gravity"], bodies["position"] = (0.0, -9.81, 0.0), places[:count]
    rows.points[0]["enabled"] = 1
    counts["shapes"], counts["bodies"], counts["points"] = count + fixed + 1, count, 1
    return Scene(rows, counts, capacities, bodies["position"][0] + (0.0, RADIUS - _PRESSED, 0.0))


def _places_on_a_floor(count: int) -> F8:
    """Return centres of bodies on a square grid, half a millimetre in the floor [m], shape [count, 3]."""
    side, numbers = max(1, int(np.ceil(np.sqrt(count)))), np.arange(count)
    places = np.full((count, 3), RADIUS - 5e-4)
    places[:, 0], places[:, 2] = (numbers % side) * (2 * RADIUS + _GAP), (numbers // side) * (2 * RADIUS + _GAP)
    return places


def boxes_in_a_heap(count: int) -> Scene:
    """Return boxes at rest in a shaft, on and beside one another, awake; the HIP touches none.

    Args:
        count: Number of boxes; with some hundreds the penetration of the lowest reaches their size.
    """
    world = heap_of_boxes(count)
    world.run(_HEAP_TICKS)
    bodies = world.rows.bodies
    bodies["position"], bodies["orientation"] = world.motions["position"], world.motions["orientation"]
    return Scene(world.rows, world.counts, ObjectCapacities(shapes=count + 5, bodies=count), np.full(3, 1.0))


Build = Callable[[int], Scene]

BODY_WORKLOADS: dict[str, Build] = {
    "bodies sphere": partial(bodies_on_a_floor, ShapeKind.SPHERE),
    "bodies box": partial(bodies_on_a_floor, ShapeKind.BOX),
    "bodies cylinder": partial(bodies_on_a_floor, ShapeKind.CYLINDER),
}
"""Workloads of moving bodies: function of their number, by name."""


def _harness_us(scene: Scene, row: HarnessRow) -> float:
    """Return the cost of a tick called from Python [us], over the rounds and ticks of a harness."""
    hand = _Hand(scene)
    return shortest_us(lambda: hand.run_from_python(row.steps), row.steps, row.rounds)


def _tick_p99_us(scene: Scene) -> float:
    """Return the 99th percentile of the duration of the whole tick in the live loop [us], after its first second."""
    memory = SessionMemory(Capacities(objects=scene.capacities))
    engine = HapticEngine(memory, build_device(Robot(), Patient(), _VIA_POINTS, 1), objects=scene.fresh_work())
    block = scene_from_components(Robot())
    block["objects"] = scene.counts
    engine.publish(block, scene.rows)
    engine.start()
    clock = MonotonicClock()
    clock.sleep_until_ns(clock.now_ns() + round(_LIVE_S * 1e9))
    engine.stop()
    return engine.histogram().duration_p99


def _shape_rows(step: Step, reference: float) -> Iterator[_Row]:
    for name, kind in _SHAPES.items():
        for count in _COUNTS:
            step(f"{name} x {count}")
            yield _shape_row(name, count, kind, count, 0, reference)
    for triangles in _TRIANGLES:
        step(f"mesh of {triangles}")
        yield _shape_row("mesh", triangles, ShapeKind.MESH, 1, triangles, reference)


def _shape_row(work: str, n: int, kind: ShapeKind, count: int, triangles: int, reference: float) -> _Row:
    scene = touch_scene(kind, count, triangles)
    us = scene.cost_us()
    capacities = ObjectCapacities(shapes=count)
    rows = new_rows(capacities)
    rows.shapes[:] = scene.rows.shapes
    rows.points[:] = scene.rows.points
    whole = _tick_p99_us(Scene(rows, scene.counts, capacities, scene.path[-1], scene.work.meshes))
    return _Row(work, n, us, us / reference, whole)


def _body_row(name: str, count: int, scene: Scene, reference: float) -> _Row:
    us = best_us(_Hand(scene).run)
    return _Row(name, count, us, us / reference, _tick_p99_us(scene))


def _mixed_row(step: Step, reference: float) -> Iterator[_Row]:
    """Yield the row of a hundred boxes of which ten move."""
    step(f"{_MIXED} boxes, {_MOVING} of them moving")
    scene = bodies_on_a_floor(ShapeKind.BOX, _MOVING, _MIXED - _MOVING)
    yield _body_row(f"boxes, {_MOVING} moving", _MIXED, scene, reference)


def _heap_rows(step: Step, reference: float) -> Iterator[_Row]:
    """Yield the rows of heaps of boxes, which no peer is measured on."""
    for count in _HEAPS:
        step(f"bodies heap x {count}")
        yield _body_row("bodies heap", count, boxes_in_a_heap(count), reference)


def _body_rows(step: Step, reference: float, harness: Sequence[HarnessRow]) -> Iterator[_Row]:
    """Yield the rows of bodies on a floor: one for every peer measured beside them, or one without."""
    for name, build in BODY_WORKLOADS.items():
        kind = name.removeprefix("bodies ")
        for count in _BODIES:
            step(f"{name} x {count}")
            row = _body_row(name, count, build(count), reference)
            beside = [*_imported(kind, count, build), *_by_harness(kind, count, build, harness)]
            yield from [replace(row, us_from_python=own, peer=peer, peer_us=us) for peer, us, own in beside] or [row]


def _imported(kind: str, count: int, build: Build) -> Iterator[tuple[str, float, float]]:
    """Yield name, cost [us] and own cost from Python [us] of every peer that can be imported."""
    for peer in PEERS.values():
        measured = measure_peer(peer, kind, count, SLIDE)
        if measured is not None:
            yield *measured, best_us(_Hand(build(count)).run_from_python)


def _by_harness(
    kind: str, count: int, build: Build, harness: Sequence[HarnessRow]
) -> Iterator[tuple[str, float, float]]:
    for row in harness:
        if (row.kind, row.count) == (kind, count):
            yield row.engine, row.us, _harness_us(build(count), row)


def measure_haptic(step: Step = lambda _: None, peers: Path | None = None) -> dict[str, Any]:
    """Return the object of `mimics bench haptic`.

    Args:
        step: Called with a description of the next measurement.
        peers: Folder with harnesses of further peers, see `haptic_harness`; None: there are none.

    Raises:
        UsageError: There is no harness in the folder.
    """
    harness = run_harnesses(peers, step) if peers is not None else []
    reference = reference_us()
    parts = (
        _shape_rows(step, reference),
        _body_rows(step, reference, harness),
        _mixed_row(step, reference),
        _heap_rows(step, reference),
    )
    rows = [row for part in parts for row in part]
    absent = [name for name in PEERS if not any((row.peer or "").startswith(name) for row in rows)]
    step("points of contact")
    points = [asdict(row) for row in measure_points()]
    figures = [row.figures() for row in rows]
    return {"reference_ns": reference * 1e3, "not_measured": absent, "rows": figures, "points": points}
