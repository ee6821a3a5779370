"""Observation of a task in one frame: values of the snapshot, and the contacts since the last frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.loop.haptic import EventKind, SafetyState, point_of_body
from mimics_app.contracts.loop.loop_fields import PointSnapshot
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.contracts.ports.display_port import FrameTiming
from mimics_app.maths.length import length

__all__ = ["Contact", "Observation", "PointObservation", "observe"]

_LATCHED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)
_MOVABLE = (SafetyState.READY, SafetyState.ACTIVE, SafetyState.DEGRADED)
_QUIET_TICKS = 100
"""Ticks without a large force after which the loop begins its soft start at once."""


@dataclass(frozen=True, slots=True)
class Contact:
    """Begin or end of a contact of a point of contact of the device.

    Attributes:
        t_ns: Time [ns].
        begins: True at the begin.
        force: Force at the begin [N].
        point: Number of the point in the device's descriptor.
    """

    t_ns: int
    begins: bool
    force: float
    point: int = 0


class PointObservation(msgspec.Struct, frozen=True):
    """One point of contact of the device in one frame.

    Attributes:
        hip_world: Where it is [m].
        speed: Its speed [m/s].
        force: Felt there [N].
        touching: Number of partners in contact with it now: wall of a tunnel, static scene, bodies.
        grasp: Grasp force [N].
        held: Name of the body that it holds; "" for none.
        crushed: Name of the held body that was pressed too hard; "" for none.
        progress: In its own tunnel, 0-1: the task's where it has that one, else its first; 0 without one.
        distance: From the bisector of that tunnel [m]; 0 without one.
        force_peak: Largest force felt there in the trial so far, of every tick [N].
        distance_peak: Largest distance from the bisector likewise [m]; 0 without a tunnel.
        progress_peak: Largest progress likewise, 0-1; 0 without a tunnel.
        own_work: Work of the person there in the trial so far [J].
    """

    hip_world: Vec3
    speed: float
    force: float
    touching: int
    grasp: float
    held: str
    crushed: str
    progress: float
    distance: float
    force_peak: float
    distance_peak: float
    progress_peak: float
    own_work: float


class Observation(msgspec.Struct, frozen=True):
    """One frame; changed by `msgspec.structs.replace`, in a thirtieth of the time of a dataclass's.

    What a device with several points of contact has for each is in `points`; `hip_world`, `speed`, `force`, `grasp`,
    `held` and `crushed` are those of the first, which leads a task that names no other.

    Attributes:
        snapshot: The newest snapshot of the loop.
        now_ns: Time of the frame [ns].
        latched: The loop is in SAFE_STOP or E_STOP.
        movable: The robot follows its controller.
        quiet: The virtual force has been small enough to begin with it for a tenth of a second.
        cause: TripCause.
        q: Joints [m, rad, m].
        hip_world: The HIP [m].
        speed: Its speed [m/s].
        force: Felt by the user [N].
        progress: Share of the trial's path that is done, 0-1, as the kind of task means it.
        distance: From the path that the task gives [m]; None where it gives none.
        force_peak: Largest force felt at any point in the trial so far, of every tick [N].
        distance_peak: Largest distance from the path likewise [m]; None where the loop does not follow a path.
        progress_peak: Largest progress likewise, 0-1; None where the loop does not follow a path.
        own_work: Work of the person at all points in the trial so far [J]; at most 0 for a hand that does nothing.
        touching: Number of partners in contact now, over all points: wall of the tunnel, static scene, bodies.
        contacts: Since the last frame, oldest first.
        grasp: Grasp force [N].
        bodies: Centre of each haptic body by name [m].
        held: Name of the body in the hand; "" for none.
        crushed: Name of the body in the hand that was pressed too hard; "" for none.
        pressed: Names of keys and buttons that went down since the last frame.
        shown_ns: Predicted time at which the frame is displayed [ns].
        period_ns: Time from one displayed frame to the next [ns].
        points: Every point of contact, in the order of the device's descriptor.
        head: The person's tracked head; None: not tracked.
    """

    snapshot: HapticSnapshot
    now_ns: int
    latched: bool
    movable: bool
    quiet: bool
    cause: int
    q: tuple[float, ...]
    hip_world: Vec3
    speed: float
    force: float
    progress: float
    distance: float | None
    touching: int
    contacts: tuple[Contact, ...]
    force_peak: float = 0.0
    distance_peak: float | None = None
    progress_peak: float | None = None
    own_work: float = 0.0
    grasp: float = 0.0
    bodies: Mapping[str, Vec3] = msgspec.field(default_factory=dict)
    held: str = ""
    crushed: str = ""
    pressed: tuple[str, ...] = ()
    shown_ns: int = 0
    period_ns: int = 0
    points: tuple[PointObservation, ...] = ()
    head: HeadPlace | None = None


def observe(
    snapshot: HapticSnapshot,
    events: NDArray[Any],
    now_ns: int,
    bodies: Sequence[str] = (),
    pressed: tuple[str, ...] = (),
    timing: FrameTiming | None = None,
    head: HeadPlace | None = None,
) -> Observation:
    """Return the observation of a frame.

    Args:
        snapshot: The newest snapshot.
        events: EVENT records since the last frame, shape [n].
        now_ns: Time of the frame [ns].
        bodies: Names of the haptic bodies in the order of their rows.
        pressed: Names of keys and buttons that went down since the last frame.
        timing: When the frame is displayed; None: as expected.
        head: The person's tracked head; None: not tracked.
    """
    timing = timing or FrameTiming.expected(now_ns)
    points = tuple(_point(each, bodies) for each in snapshot.points)
    first = points[0]
    return Observation(
        snapshot=snapshot,
        now_ns=now_ns,
        latched=snapshot.state in _LATCHED,
        movable=snapshot.state in _MOVABLE,
        quiet=snapshot.quiet_ticks >= _QUIET_TICKS,
        cause=snapshot.cause,
        q=tuple(snapshot.q.tolist()),
        hip_world=first.hip_world,
        speed=first.speed,
        force=first.force,
        progress=0.0,
        distance=None,
        touching=sum(each.touching for each in points),
        shown_ns=timing.display_ns,
        period_ns=timing.period_ns,
        contacts=_contacts(events) if len(events) else (),
        force_peak=max(each.force_peak for each in points),
        own_work=sum(each.own_work for each in points),
        grasp=first.grasp,
        bodies={
            name: (x, y, z) for name, (x, y, z) in zip(bodies, snapshot.poses[: len(bodies), :3].tolist(), strict=True)
        },
        held=first.held,
        crushed=first.crushed,
        pressed=pressed,
        points=points,
        head=head,
    )


def _point(snapshot: PointSnapshot, bodies: Sequence[str]) -> PointObservation:
    return PointObservation(
        hip_world=_vector(snapshot.hip_world),
        speed=length(snapshot.v_world),
        force=length(snapshot.f_user_world),
        touching=int(snapshot.penetration > 0.0) + snapshot.partners,
        grasp=snapshot.grasp,
        held=_name(bodies, snapshot.held_body),
        crushed=_name(bodies, snapshot.crushed_body),
        progress=snapshot.progress,
        distance=snapshot.distance,
        force_peak=snapshot.force_peak,
        distance_peak=snapshot.distance_peak,
        progress_peak=snapshot.progress_peak,
        own_work=snapshot.own_work,
    )


def _contacts(events: NDArray[Any]) -> tuple[Contact, ...]:
    return tuple(
        Contact(
            int(event["t_ns"]),
            bool(event["kind"] == EventKind.CONTACT_BEGIN),
            float(event["force"]),
            point_of_body(int(event["body_a"])),
        )
        for event in events
        if event["kind"] in (EventKind.CONTACT_BEGIN, EventKind.CONTACT_END)
    )


def _name(bodies: Sequence[str], row: int) -> str:
    return bodies[row] if 0 <= row < len(bodies) else ""


def _vector(values: NDArray[np.float64]) -> Vec3:
    x, y, z = values.tolist()
    return x, y, z
