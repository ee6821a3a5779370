"""Table of all numbers that leave the 1 kHz loop: sample, snapshot, recording and their units are derived from it.

A new number is a row here and a kernel that writes the field of that name in STATE. The row adds it to the samples and
so to every recording; `reader` adds it to the snapshot, with one typed line in `HapticSnapshot` below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import Vec

__all__ = [
    "LOOP_FIELDS",
    "MAX_CONTACTS",
    "MAX_JOINTS",
    "Extent",
    "HapticSnapshot",
    "LoopField",
    "Move",
    "Replay",
    "check_snapshot",
    "moves_of",
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

_OTHERS = MAX_CONTACTS - 1
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
    """

    joints: tuple[str, ...] = ("m", "rad", "m")
    contacts: int = 1
    torques: bool = False
    reference: bool = False


class Per(Enum):
    """Meaning of a field's components: how many a device fills, and in which units."""

    TICK = "fixed components"
    JOINT = "one for each joint, in its unit"
    JOINT_RATE = "one for each joint, in its unit per second"
    JOINT_ACCELERATION = "one for each joint, in its unit per second squared"
    JOINT_SHARE = "one for each joint, dimensionless"
    TORQUE = "one for each joint of a device with torques, N or N m"
    CONTACT = "the same number of components for each point of contact after the first"


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
        size: Number of components.
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
            raise ValueError(f"{self.name}: {self.unit!r} is no unit for each of {self.size} components")
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
        """Return the units of the components that a device fills, the first ones of the field; () for none."""
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
        if self.per is Per.CONTACT:
            return self.units[: self.size // _OTHERS * (extent.contacts - 1)]
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


def _of_others(name: str, unit: str, replay: Replay, each: int = 1) -> LoopField:
    """Return a field with `each` components for every point of contact after the first."""
    return LoopField(name, unit, replay, "state", size=each * _OTHERS, per=Per.CONTACT)


LOOP_FIELDS: tuple[LoopField, ...] = (
    LoopField("t", "s", Replay.CLOCK, ""),  # session time = tick / rate
    LoopField("tick", "1", Replay.CLOCK, "", "i8", reader="app"),
    LoopField("t_ns", "ns", Replay.ABSENT, "", "i8", reader="scenarios"),  # of the tick's release, monotonic
    # inputs; the snapshot has the last good ones
    _of_joints("q", Replay.INPUT, reader="tasks"),  # measured joints
    _of_joints("dq", Replay.INPUT, "", per=Per.JOINT_RATE),
    LoopField("f_meas", "N", Replay.INPUT, "", size=3),  # force of the user on the handle, tool frame r t z
    LoopField("grasp", "N", Replay.INPUT, reader="tasks"),
    LoopField("buttons", "1", Replay.INPUT, ""),  # Button bits
    LoopField("age", "s", Replay.INPUT, ""),  # of the device's data when read
    LoopField("delay", "s", Replay.INPUT, ""),  # from a command to the data that shows it, as the device measures it
    LoopField("status", "1", Replay.INPUT, ""),  # DeviceStatus
    LoopField("sequence", "1", Replay.INPUT, ""),  # SCENE block this tick used
    LoopField("stop_word", "1", Replay.INPUT, ""),  # stop key as this tick saw it
    LoopField("held", "1", Replay.INPUT, ""),  # late-tick class: 0 in time, 1 hold, 2 damp, 3 stop, 4 missed in a row
    LoopField("period_s", "s", Replay.INPUT, ""),  # measured, mean weighted by length; nominal on a virtual clock
    # motion and force
    LoopField("hip_world", "m", Replay.OUTPUT, size=3, reader="tasks"),  # haptic interaction point
    LoopField("v_world", "m/s", Replay.OUTPUT, size=3, reader="tasks"),  # its velocity
    LoopField("f_meas_world", "N", Replay.ABSENT, size=3, reader="app"),  # f_meas in the world
    LoopField("f_virt_world", "N", Replay.OUTPUT, size=3),  # virtual force on the user before the limiter
    LoopField(
        "f_user_world", "N", Replay.OUTPUT, size=3, reader="tasks"
    ),  # after limiter and ramp: what the user feels
    # objects
    LoopField("f_shapes", "N", Replay.OUTPUT, "totals.shape_force", size=3),  # part that touched shapes make, world
    LoopField("f_effects", "N", Replay.OUTPUT, "totals.effect_force", size=3),  # part that effects make, world
    LoopField("f_grip", "N", Replay.OUTPUT, "totals.grip_force", size=3, reader="app"),  # part of the held object
    LoopField("touching", "1", Replay.OUTPUT, "totals.touching"),  # pairs of point and shape in contact
    LoopField("partners", "1", Replay.ABSENT, kind="i8", reader="tasks"),  # in contact, of static scene and bodies
    LoopField("depth", "m", Replay.OUTPUT, "totals.depth"),  # of the deepest of them
    LoopField("touched_shape", "1", Replay.OUTPUT, "totals.shape"),  # its row, -1: none
    LoopField("held_body", "1", Replay.OUTPUT, "totals.held", "i8", reader="tasks"),  # its row, -1: none
    LoopField("crushed_body", "1", Replay.ABSENT, "totals.crushed", "i8", reader="tasks"),  # held beyond crush_force
    LoopField("bodies", "1", Replay.OUTPUT),  # checksum of the motion of all bodies, 0-2^52
    # the task's own tunnel
    LoopField("f_tunnel", "N", Replay.OUTPUT, "state.own_tunnel.force_tnb", size=3),  # in the tunnel's t, n, b
    LoopField("s", "pieces", Replay.OUTPUT, "state.own_tunnel.s"),  # parameter of the closest bisector point
    LoopField("progress", "1", Replay.OUTPUT, "state.own_tunnel.progress", reader="tasks"),  # of the arc length, 0-1
    LoopField("distance", "m", Replay.OUTPUT, "state.own_tunnel.distance", reader="tasks"),  # ball from bisector
    LoopField("offset_n", "m", Replay.OUTPUT, "state.own_tunnel.offset_n"),  # along the tunnel's n
    LoopField("offset_b", "m", Replay.OUTPUT, "state.own_tunnel.offset_b"),  # along the tunnel's b
    LoopField("penetration", "m", Replay.OUTPUT, "state.own_tunnel.penetration", reader="tasks"),  # ball in wall
    LoopField("ball_radius", "m", Replay.OUTPUT, reader="scenarios"),
    LoopField("tunnel_radius", "m", Replay.OUTPUT, "state.own_tunnel.radius"),  # at s, scaled
    # controller and safety
    LoopField("v_virtual", "m/s", Replay.OUTPUT, size=3),  # velocity of the virtual mass, robot frame
    _of_joints("command", Replay.OUTPUT, per=Per.JOINT_RATE),  # joint velocities sent
    LoopField("f_command", "N", Replay.OUTPUT, size=3),  # force sent, robot frame
    LoopField("ramp", "1", Replay.OUTPUT, reader="scenarios"),  # soft-start factor 0-1
    LoopField("state", "1", Replay.OUTPUT, "state.safety", "i8", reader="tasks"),  # SafetyState
    LoopField(
        "cause", "1", Replay.OUTPUT, kind="i8", reader="tasks"
    ),  # TripCause of the stop or degraded state it is in
    # stability
    LoopField("stiffness_limit", "N/m", Replay.OUTPUT),  # largest stable stiffness of a contact, this period and delay
    LoopField("margin", "1", Replay.OUTPUT, reader="app"),  # that over the wall's stiffness, less 1; below 0: may swing
    LoopField("energy", "J", Replay.OUTPUT, "state.observer.energy", reader="app"),  # taken since the contact began
    LoopField(
        "stiffness_share", "1", Replay.OUTPUT, reader="app"
    ),  # of what is or can be touched that is rendered, 0-1
    LoopField("credit", "J", Replay.OUTPUT, "state.acting.credit"),  # contacts may still give back; < 0: gave too much
    LoopField("passivity", "N", Replay.OUTPUT, "state.acting.passivity"),  # force the passivity controller took away
    LoopField("tank", "J", Replay.OUTPUT, "state.acting.tank"),  # energy left for active forces
    LoopField("tank_share", "1", Replay.OUTPUT, "state.acting.tank_share"),  # of the active forces it can pay, 0-1
    # the live loop
    LoopField("lateness_ns", "ns", Replay.TIMING, ""),  # wake-up after the release
    LoopField("duration_ns", "ns", Replay.TIMING, ""),  # work of the tick
    # devices with torques
    _of_joints("torque_meas", Replay.INPUT, per=Per.TORQUE),  # of the user on the joints, beside the forces on points
    _of_joints("torque_command", Replay.OUTPUT, per=Per.TORQUE),  # torques sent
    # points of contact behind the first
    _of_others("others_f_meas", "N", Replay.INPUT, 3),  # force of the user on each, frame of its sensor
    _of_others("others_world", "m", Replay.OUTPUT, 3),  # where they are
    _of_others("others_v_world", "m/s", Replay.OUTPUT, 3),
    _of_others("others_f_virt_world", "N", Replay.OUTPUT, 3),  # virtual force on the user before the limiter
    _of_others("others_f_user_world", "N", Replay.OUTPUT, 3),  # after it
    _of_others("others_depth", "m", Replay.OUTPUT),  # of the deepest shape each is in
    _of_others("others_margin", "1", Replay.OUTPUT),  # stability margin of what each touches
    _of_others("others_share", "1", Replay.OUTPUT),  # of the stiffness of what each touches that is rendered, 0-1
    _of_others("others_energy", "J", Replay.OUTPUT),  # taken by each since its contact began
    # oscillation
    LoopField("calm", "1", Replay.OUTPUT, reader="app"),  # share of the force that the detector of oscillation left
    LoopField("f_ordered", "N", Replay.OUTPUT, "totals.ordered_force", size=3),  # effects and ripples meant to shake
    # reference of the joints
    LoopField("phase", "1", Replay.OUTPUT, reader="app", reference=True),  # of its cycle, 0-1
    LoopField("amplitude", "1", Replay.OUTPUT, reference=True),  # 0 in standing, 1 in the whole movement
    _of_reference("q_reference", Per.JOINT),
    _of_reference("dq_reference", Per.JOINT_RATE),
    _of_reference("ddq_reference", Per.JOINT_ACCELERATION),
    _of_reference("guidance", Per.JOINT_SHARE),  # share of the pull towards it
    # of the trial so far, over the ticks in which the person leads
    LoopField("force_peak", "N", Replay.ABSENT, reader="tasks"),  # largest force felt
    LoopField("distance_peak", "m", Replay.ABSENT, reader="tasks"),  # largest distance of the ball from the bisector
    LoopField("progress_peak", "1", Replay.ABSENT, reader="tasks"),  # largest progress in the task's own tunnel
    LoopField("own_work", "J", Replay.ABSENT, reader="tasks"),  # of the person on the handle
    LoopField("quiet_ticks", "1", Replay.ABSENT, "state.quiet_ticks", "i8", reader="tasks"),  # without a force to begin
    LoopField("others_seen", "m", Replay.ABSENT, "state.others_world", size=3 * _OTHERS, reader="scenarios"),
)
"""All numbers that leave the loop, recorded columns in the order of the recording."""


@dataclass(frozen=True, slots=True)
class HapticSnapshot:
    """Newest haptic state for the frame: rows of `LOOP_FIELDS` that have a reader, vectors of shape [3].

    Attributes:
        q: Measured joints, shape [joints of the device].
        others_seen: Points of contact after the first, world [m], shape [MAX_CONTACTS - 1, 3].
        poses: Position xyz [m] and quaternion xyzw of each body, world, shape [capacity, 7].
    """

    tick: int
    t_ns: int
    q: Vec
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
    ramp: float
    state: int
    cause: int
    margin: float
    energy: float
    stiffness_share: float
    calm: float
    phase: float
    force_peak: float
    distance_peak: float
    progress_peak: float
    own_work: float
    quiet_ticks: int
    others_seen: Vec
    poses: Vec


def check_snapshot(table: Sequence[LoopField]) -> None:
    """Compare HapticSnapshot with the table.

    Raises:
        TypeError: A row with a reader has no field of its type in the message, or a field has no row.
    """
    wanted = {field.name: "Vec" if field.shape else _TYPES[field.kind] for field in table if field.reader}
    found = {field.name: field.type for field in fields(HapticSnapshot) if field.name != "poses"}
    differing = sorted(name for name in wanted | found if wanted.get(name) != found.get(name))
    if differing:
        raise TypeError(f"HapticSnapshot and its table differ in {', '.join(differing)}: give each row with a "
                        "reader one line, int, float or Vec")  # fmt: skip


def sample_dtype(table: Sequence[LoopField]) -> np.dtype[Any]:
    """Return the dtype of a sample; all fields are float64, so that a row is also a float64 vector."""
    return np.dtype([(field.name, "f8", field.shape) for field in table if field.replay is not Replay.ABSENT])


def snapshot_dtype(table: Sequence[LoopField]) -> np.dtype[Any]:
    """Return the dtype of the newest state."""
    return np.dtype([(field.name, field.kind, field.shape) for field in table if field.reader], align=True)


def state_fields(table: Sequence[LoopField]) -> list[tuple[Any, ...]]:
    """Return the fields of STATE that the table declares: outputs that no kernel reads."""
    return [(field.name, field.kind, field.shape) for field in table if field.source == "state"]


def moves_of(table: Sequence[LoopField], *, recorded: bool) -> tuple[Move, ...]:
    """Return the copies from the loop's records to the outputs of a sample, or to a snapshot."""
    if recorded:
        return tuple(field.move for field in table if field.replay is Replay.OUTPUT)
    return tuple(field.move for field in table if field.reader and field.source)


check_snapshot(LOOP_FIELDS)
