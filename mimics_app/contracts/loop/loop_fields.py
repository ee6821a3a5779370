"""Table of all numbers that leave the 1 kHz loop: sample, snapshot, recording and their units are derived from it.

A new number is a row here and a kernel that writes the field of that name in STATE. The row adds it to the samples and
so to every recording; `reader` adds it to the snapshot, with one typed line in `HapticSnapshot` below.

A device has 1 to MAX_CONTACTS points of contact, and a row "of each point" has its number for every one of them. In
samples and snapshots the first point has the field of that name; the others have it in the rows of FURTHER, which lie
behind all other numbers, so that those of a device with one point are the beginning of every sample. `point_rows` is
the one table of all points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import Records, Vec

__all__ = [
    "FURTHER",
    "LOOP_FIELDS",
    "MAX_CONTACTS",
    "MAX_JOINTS",
    "MAX_NUMBERS",
    "Extent",
    "HapticSnapshot",
    "LoopField",
    "Move",
    "Per",
    "PointSnapshot",
    "Replay",
    "check_snapshot",
    "contacts_in",
    "moves_of",
    "point_rows",
    "sample_dtype",
    "snapshot_dtype",
    "state_fields",
]


Move = tuple[int, tuple[str, ...], str]
"""Copy of a field: source record (0: STATE, 1: TOTALS of the objects), path in it, and name of the target field."""

MAX_JOINTS = 8
"""Largest number of joints of a device, and length of every vector of joints in the loop, zero beyond the device's."""

MAX_CONTACTS = 4
"""Largest number of points of contact of a device."""

MAX_NUMBERS = 16
"""Largest number of columns that a controller declares for itself."""

FURTHER = "further"
"""Field of samples and snapshots with one row for each point of contact after the first, shape [MAX_CONTACTS - 1]."""

_TORQUE_UNITS = {"m": "N", "rad": "N m"}

_RECORDS = ("state", "totals")
_TYPES = {"i8": "int", "f8": "float"}


class Replay(Enum):
    """Role of a column of the recording in a replay."""

    CLOCK = "counts the ticks"
    INPUT = "is an input of the tick, as read from the device"
    OUTPUT = "is compared bit for bit and part of the state hash"
    TIMING = "is the punctuality of the live loop; ignored"
    ABSENT = "is not recorded"


@dataclass(frozen=True, slots=True)
class Extent:
    """Subset of the loop's numbers that a device has: the recorded components of the samples, and their units.

    Attributes:
        joints: Unit of each joint, "m" or "rad"; in older recordings those of the HapticMaster.
        contacts: Number of points of contact.
        torques: Whether the device measures and takes joint torques.
        reference: Whether the scene has a reference of the joints.
        numbers: Name and unit of each column of the scene's controller, as it declares them.
        gait: Whether that controller has gait states.
    """

    joints: tuple[str, ...] = ("m", "rad", "m")
    contacts: int = 1
    torques: bool = False
    reference: bool = False
    numbers: tuple[tuple[str, str], ...] = ()
    gait: bool = False


class Per(Enum):
    """Meaning of a field's components: how many a device fills, and in which units."""

    TICK = "fixed components"
    JOINT = "one for each joint, in its unit"
    JOINT_RATE = "one for each joint, in its unit per second"
    JOINT_ACCELERATION = "one for each joint, in its unit per second squared"
    JOINT_SHARE = "one for each joint, dimensionless"
    TORQUE = "one for each joint of a device with torques, N or N m"
    POINT = "fixed components for each point of contact"
    CONTROLLER = "one for each column that the controller declares"
    GAIT = "one, of a controller with gait states"


@dataclass(frozen=True, slots=True)
class LoopField:
    """One scalar or vector output of the loop.

    Attributes:
        name: Name of its field in SAMPLE and SNAPSHOT.
        unit: SI unit, "1" for dimensionless; one per component where they differ.
        replay: Role in a replay; the order of OUTPUT and INPUT columns is fixed, new ones are appended.
        source: "state": the field of STATE with this name, which this row declares; "state.own_tunnel.s",
            "totals.depth": a field that a kernel declares; "": written by the loop itself (kernels.rows, loop).
        kind: "f8" or "i8", in STATE and SNAPSHOT; samples hold float64 only.
        size: Number of components; of one point where it has them for each.
        reader: Package below mimics_app that reads it from the snapshot; "": recorded only.
        per: Meaning of the components; units of joints are those of the device.
        reference: Whether only scenes with a reference of the joints have it.
    """

    name: str
    unit: str | tuple[str, ...]
    replay: Replay
    source: str = "state"
    kind: str = "f8"
    size: int = 1
    reader: str = ""
    per: Per = Per.TICK
    reference: bool = False

    def __post_init__(self) -> None:
        if not all(self.units) or len(self.units) != self.size:
            raise ValueError(f"{self.name}: {self.unit!r} does not have one unit for each of {self.size} components")
        if self.kind not in _TYPES:
            raise ValueError(f"{self.name}: kind {self.kind!r} is none of {', '.join(_TYPES)}")
        if self.source and self.source.partition(".")[0] not in _RECORDS:
            raise ValueError(f"{self.name}: source {self.source!r} begins with none of {', '.join(_RECORDS)}")
        if self.replay is Replay.ABSENT and not self.reader:
            raise ValueError(f"{self.name} is neither recorded nor read")

    @property
    def units(self) -> tuple[str, ...]:
        """One unit per component."""
        return (self.unit,) * self.size if isinstance(self.unit, str) else self.unit

    def present(self, extent: Extent) -> tuple[str, ...]:
        """Return the units of the components that a device fills, the first ones of the field; () for none.

        Of a field of each point those of one point.
        """
        if self.reference and not extent.reference:
            return ()
        if self.per is Per.JOINT:
            return extent.joints
        if self.per is Per.JOINT_RATE:
            return tuple(f"{unit}/s" for unit in extent.joints)
        if self.per is Per.JOINT_ACCELERATION:
            return tuple(f"{unit}/s^2" for unit in extent.joints)
        if self.per is Per.JOINT_SHARE:
            return ("1",) * len(extent.joints)
        if self.per is Per.TORQUE:
            return tuple(_TORQUE_UNITS[unit] for unit in extent.joints) if extent.torques else ()
        if self.per is Per.CONTROLLER:
            return tuple(unit for _, unit in extent.numbers)
        if self.per is Per.GAIT and not extent.gait:
            return ()
        return self.units

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the field: () for a scalar."""
        return () if self.size == 1 else (self.size,)

    @property
    def move(self) -> Move:
        """Source of the field in the loop's records."""
        record, _, path = self.source.partition(".")
        return _RECORDS.index(record), tuple(path.split(".")) if path else (self.name,), self.name


def _of_joints(name: str, replay: Replay, source: str = "state", reader: str = "", per: Per = Per.JOINT) -> LoopField:
    """Return a field with a component for each joint, in the device's units ("joint")."""
    return LoopField(name, "joint", replay, source, size=MAX_JOINTS, reader=reader, per=per)


def _of_reference(name: str, per: Per) -> LoopField:
    """Return a field of the reference with a component for each joint."""
    return LoopField(name, "joint", Replay.OUTPUT, size=MAX_JOINTS, per=per, reference=True)


def _of_points(
    name: str, unit: str, replay: Replay, source: str = "state", kind: str = "f8", size: int = 1, reader: str = ""
) -> LoopField:
    """Return a field with `size` components for each point of contact."""
    return LoopField(name, unit, replay, source, kind, size, reader, Per.POINT)


LOOP_FIELDS: tuple[LoopField, ...] = (
    LoopField("t", "s", Replay.CLOCK, ""),  # session time = tick / rate
    LoopField("tick", "1", Replay.CLOCK, "", "i8", reader="app"),
    LoopField("t_ns", "ns", Replay.ABSENT, "", "i8", reader="scenarios"),  # of the tick's release, monotonic
    # inputs; the snapshot has the last good ones
    _of_joints("q", Replay.INPUT, reader="tasks"),  # measured joints
    _of_joints("dq", Replay.INPUT, "", per=Per.JOINT_RATE),
    _of_points("f_meas", "N", Replay.INPUT, "", size=3),  # force of the user on the handle, tool frame r t z
    _of_points("grasp", "N", Replay.INPUT, reader="tasks"),
    LoopField("buttons", "1", Replay.INPUT, ""),  # Button bits
    LoopField("age", "s", Replay.INPUT, ""),  # of the device's data when read
    LoopField("delay", "s", Replay.INPUT, ""),  # from a command to the data that shows it, as the device measures it
    LoopField("status", "1", Replay.INPUT, ""),  # DeviceStatus
    LoopField("sequence", "1", Replay.INPUT, ""),  # SCENE block this tick used
    LoopField("stop_word", "1", Replay.INPUT, ""),  # stop key as this tick saw it
    LoopField("held", "1", Replay.INPUT, ""),  # late-tick class: 0 in time, 1 hold, 2 damp, 3 stop, 4 missed in a row
    LoopField("period_s", "s", Replay.INPUT, ""),  # measured, mean weighted by length; nominal on a virtual clock
    # motion and force
    _of_points("hip_world", "m", Replay.OUTPUT, size=3, reader="tasks"),  # haptic interaction point
    _of_points("v_world", "m/s", Replay.OUTPUT, size=3, reader="tasks"),  # its velocity
    _of_points("f_meas_world", "N", Replay.ABSENT, size=3, reader="app"),  # f_meas in the world
    _of_points("f_virt_world", "N", Replay.OUTPUT, size=3),  # virtual force on the user before the limiter
    _of_points(
        "f_user_world", "N", Replay.OUTPUT, size=3, reader="tasks"
    ),  # after limiter and ramp: what the user feels
    # objects
    _of_points("f_shapes", "N", Replay.OUTPUT, "totals.shape_force", size=3),  # part that touched shapes make, world
    _of_points("f_effects", "N", Replay.OUTPUT, "totals.effect_force", size=3),  # part that effects make, world
    _of_points("f_grip", "N", Replay.OUTPUT, "totals.grip_force", size=3, reader="app"),  # part of the held object
    _of_points("touching", "1", Replay.OUTPUT, "totals.touching"),  # pairs of point and shape in contact
    _of_points("partners", "1", Replay.ABSENT, kind="i8", reader="tasks"),  # in contact, of static scene and bodies
    _of_points("depth", "m", Replay.OUTPUT, "totals.depth"),  # of the deepest of them
    _of_points("touched_shape", "1", Replay.OUTPUT, "totals.shape"),  # its row, -1: none
    _of_points("held_body", "1", Replay.OUTPUT, "totals.held", "i8", reader="tasks"),  # its row, -1: none
    _of_points("crushed_body", "1", Replay.ABSENT, "totals.crushed", "i8", reader="tasks"),  # held beyond crush_force
    LoopField("bodies", "1", Replay.OUTPUT),  # checksum of the motion of all bodies, 0-2^52
    # the task's own tunnel
    _of_points("f_tunnel", "N", Replay.OUTPUT, "state.own_tunnel.force_tnb", size=3),  # in the tunnel's t, n, b
    _of_points("s", "pieces", Replay.OUTPUT, "state.own_tunnel.s"),  # parameter of the closest bisector point
    _of_points("progress", "1", Replay.OUTPUT, "state.own_tunnel.progress", reader="tasks"),  # of the arc length, 0-1
    _of_points("distance", "m", Replay.OUTPUT, "state.own_tunnel.distance", reader="tasks"),  # ball from bisector
    _of_points("offset_n", "m", Replay.OUTPUT, "state.own_tunnel.offset_n"),  # along the tunnel's n
    _of_points("offset_b", "m", Replay.OUTPUT, "state.own_tunnel.offset_b"),  # along the tunnel's b
    _of_points("penetration", "m", Replay.OUTPUT, "state.own_tunnel.penetration", reader="tasks"),  # ball in wall
    _of_points("ball_radius", "m", Replay.OUTPUT, reader="scenarios"),
    _of_points("tunnel_radius", "m", Replay.OUTPUT, "state.own_tunnel.radius"),  # at s, scaled
    # controller and safety
    LoopField("v_virtual", "m/s", Replay.OUTPUT, size=3),  # velocity of the virtual mass, robot frame
    _of_joints("command", Replay.OUTPUT, per=Per.JOINT_RATE),  # joint velocities sent
    _of_points("f_command", "N", Replay.OUTPUT, size=3),  # force sent, robot frame
    LoopField("ramp", "1", Replay.OUTPUT, reader="scenarios"),  # soft-start factor 0-1
    LoopField("state", "1", Replay.OUTPUT, "state.safety", "i8", reader="tasks"),  # SafetyState
    LoopField(
        "cause", "1", Replay.OUTPUT, kind="i8", reader="tasks"
    ),  # TripCause of the stop or degraded state it is in
    # stability
    _of_points("stiffness_limit", "N/m", Replay.OUTPUT),  # largest stable stiffness of a contact, this period and delay
    _of_points(
        "margin", "1", Replay.OUTPUT, reader="app"
    ),  # that over the wall's stiffness, less 1; below 0: may swing
    _of_points("energy", "J", Replay.OUTPUT, "state.observer.energy", reader="app"),  # taken since the contact began
    _of_points(
        "stiffness_share", "1", Replay.OUTPUT, reader="app"
    ),  # of what is or can be touched that is rendered, 0-1
    _of_points("credit", "J", Replay.OUTPUT, "state.acting.credit"),  # contacts may still give back; < 0: gave too much
    _of_points("passivity", "N", Replay.OUTPUT, "state.acting.passivity"),  # force the passivity controller took away
    _of_points("tank", "J", Replay.OUTPUT, "state.acting.tank"),  # energy left for active forces
    _of_points("tank_share", "1", Replay.OUTPUT, "state.acting.tank_share"),  # of the active forces it can pay, 0-1
    # the live loop
    LoopField("lateness_ns", "ns", Replay.TIMING, ""),  # wake-up after the release
    LoopField("duration_ns", "ns", Replay.TIMING, ""),  # work of the tick
    # devices with torques
    _of_joints(
        "torque_meas", Replay.INPUT, reader="app", per=Per.TORQUE
    ),  # of the user on the joints, beside the forces on points
    _of_joints("torque_command", Replay.OUTPUT, per=Per.TORQUE),  # torques sent
    # oscillation
    _of_points("calm", "1", Replay.OUTPUT, reader="app"),  # share of the force that the detector of oscillation left
    _of_points("f_ordered", "N", Replay.OUTPUT, "totals.ordered_force", size=3),  # effects and ripples meant to shake
    # reference of the joints
    LoopField("phase", "1", Replay.OUTPUT, reader="app", reference=True),  # of its cycle, 0-1
    LoopField("amplitude", "1", Replay.OUTPUT, reference=True),  # 0 in standing, 1 in the whole movement
    _of_reference("q_reference", Per.JOINT),
    _of_reference("dq_reference", Per.JOINT_RATE),
    _of_reference("ddq_reference", Per.JOINT_ACCELERATION),
    _of_reference("guidance", Per.JOINT_SHARE),  # share of the pull towards it
    # of the controller while the person leads
    LoopField("gait_state", "1", Replay.OUTPUT, kind="i8", reader="tasks", per=Per.GAIT),  # GaitState, -1: none
    LoopField("numbers", "1", Replay.OUTPUT, "state.control.out.numbers", size=MAX_NUMBERS, per=Per.CONTROLLER),
    # which leg an obstacle frees: 0 left, 1 right, -1: none
    LoopField("free_leg", "1", Replay.OUTPUT, kind="i8", reader="app", per=Per.GAIT),
    LoopField("belt_travel", "m", Replay.OUTPUT, reader="scenarios", per=Per.GAIT),  # of a treadmill's belt backwards
    # heel strikes of each foot so far, -1: nobody watches
    LoopField("left_strikes", "1", Replay.OUTPUT, kind="i8", reader="tasks", per=Per.GAIT),
    LoopField("right_strikes", "1", Replay.OUTPUT, kind="i8", reader="tasks", per=Per.GAIT),
    # the tunnel that holds the ball
    _of_points("wall_force", "N", Replay.ABSENT, "state.tunnel.wall_force", reader="rendering"),  # of wall and cap
    _of_points("wall_normal", "1", Replay.ABSENT, "state.tunnel.normal_world", size=3, reader="rendering"),  # unit
    # of the trial so far, over the ticks in which the person leads
    _of_points("force_peak", "N", Replay.ABSENT, reader="tasks"),  # largest force felt
    _of_points("distance_peak", "m", Replay.ABSENT, reader="tasks"),  # largest distance of the ball from the bisector
    _of_points("progress_peak", "1", Replay.ABSENT, reader="tasks"),  # largest progress in the task's own tunnel
    _of_points("own_work", "J", Replay.ABSENT, reader="tasks"),  # of the person on the handle
    LoopField("quiet_ticks", "1", Replay.ABSENT, "state.quiet_ticks", "i8", reader="tasks"),  # without a force to begin
)
"""All numbers that leave the loop, recorded columns in the order of the recording."""


@dataclass(frozen=True, slots=True)
class PointSnapshot:
    """Newest state of one point of contact: rows of each point in `LOOP_FIELDS` with a reader, vectors of shape [3]."""

    grasp: float
    hip_world: Vec
    v_world: Vec
    f_meas_world: Vec
    f_user_world: Vec
    f_grip: Vec
    partners: int
    held_body: int
    crushed_body: int
    progress: float
    distance: float
    penetration: float
    ball_radius: float
    margin: float
    energy: float
    stiffness_share: float
    calm: float
    wall_force: float
    wall_normal: Vec
    force_peak: float
    distance_peak: float
    progress_peak: float
    own_work: float


@dataclass(frozen=True, slots=True)
class HapticSnapshot(PointSnapshot):
    """Newest haptic state for the frame: that of the first point of contact, of the device, and of further points.

    Attributes:
        q: Measured joints, shape [joints of the device].
        torque_meas: Torques of the user on the joints [N, N m], shape [joints of the device].
        poses: Position xyz [m] and quaternion xyzw of each body, world, shape [capacity, 7].
        further: The points of contact after the first; () for a device with one.
    """

    tick: int
    t_ns: int
    q: Vec
    ramp: float
    state: int
    cause: int
    phase: float
    gait_state: int
    free_leg: int
    belt_travel: float
    left_strikes: int
    right_strikes: int
    torque_meas: Vec
    quiet_ticks: int
    poses: Vec
    further: tuple[PointSnapshot, ...] = ()

    @property
    def points(self) -> tuple[PointSnapshot, ...]:
        """Every point of contact of the device, in the order of its descriptor."""
        return (self, *self.further)


def check_snapshot(table: Sequence[LoopField]) -> None:
    """Compare HapticSnapshot and PointSnapshot with the table.

    Raises:
        TypeError: A row with a reader has no field of its type in the message, or a field has no row.
    """
    points = {field.name: field.type for field in fields(PointSnapshot)}
    own = {"poses", FURTHER, *points}
    device = {field.name: field.type for field in fields(HapticSnapshot) if field.name not in own}
    differing = []
    for found, rows in ((points, _of_each_point(table)), (device, [f for f in table if f.per is not Per.POINT])):
        wanted = {field.name: "Vec" if field.shape else _TYPES[field.kind] for field in rows if field.reader}
        differing += sorted(name for name in wanted | found if wanted.get(name) != found.get(name))
    if differing:
        raise TypeError(f"HapticSnapshot and its table differ in {', '.join(differing)}: give each row with a "
                        "reader one line, int, float or Vec")  # fmt: skip


def _of_each_point(table: Sequence[LoopField]) -> list[LoopField]:
    return [field for field in table if field.per is Per.POINT]


def _sample_fields(table: Sequence[LoopField]) -> list[tuple[Any, ...]]:
    return [(field.name, "f8", field.shape) for field in table if field.replay is not Replay.ABSENT]


def _snapshot_fields(table: Sequence[LoopField]) -> list[tuple[Any, ...]]:
    return [(field.name, field.kind, field.shape) for field in table if field.reader]


def sample_dtype(table: Sequence[LoopField], contacts: int = MAX_CONTACTS) -> np.dtype[Any]:
    """Return the dtype of a sample of a device with so many points; all numbers are float64, as in a float64 vector.

    That of fewer points has the first numbers of that of more.
    """
    rows = _sample_fields(table)
    if contacts > 1:
        rows.append((FURTHER, np.dtype(_sample_fields(_of_each_point(table))), (contacts - 1,)))
    return np.dtype(rows)


def snapshot_dtype(table: Sequence[LoopField]) -> np.dtype[Any]:
    """Return the dtype of the newest state."""
    point = np.dtype(_snapshot_fields(_of_each_point(table)), align=True)
    return np.dtype([*_snapshot_fields(table), (FURTHER, point, (MAX_CONTACTS - 1,))], align=True)


def contacts_in(samples: Records) -> int:
    """Return the number of points of contact that samples have room for."""
    dtype = samples.dtype
    return 1 + dtype[FURTHER].shape[0] if FURTHER in (dtype.names or ()) else 1


def point_rows(records: Records, point: int) -> Records:
    """Return the numbers of one point of contact, from 0, in samples or snapshots: fields of the same names for each.

    Args:
        records: SAMPLE or SNAPSHOT records, shape [n].
        point: Number of the point in the device's descriptor.

    Returns:
        A view, shape [n].

    Raises:
        IndexError: The records have no such point.
    """
    names = records.dtype.names or ()
    if point == 0:
        of_one = {field.name for field in _of_each_point(LOOP_FIELDS)}
        return records[[name for name in names if name in of_one]]
    if FURTHER not in names:
        raise IndexError(f"point of contact {point} of a recording of one")
    rows: Records = records[FURTHER][..., point - 1]
    return rows


def state_fields(table: Sequence[LoopField]) -> list[tuple[Any, ...]]:
    """Return the fields of STATE that the table declares: outputs that no kernel reads."""
    return [(field.name, field.kind, field.shape) for field in table if field.source == "state"]


def moves_of(table: Sequence[LoopField], *, recorded: bool) -> tuple[Move, ...]:
    """Return the copies from the loop's records to the outputs of a sample, or to a snapshot.

    For a row of FURTHER give the rows of each point (`Per.POINT`) alone.
    """
    if recorded:
        return tuple(field.move for field in table if field.replay is Replay.OUTPUT)
    return tuple(field.move for field in table if field.reader and field.source)


check_snapshot(LOOP_FIELDS)
