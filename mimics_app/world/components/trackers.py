"""Settings of the trackers of a scene: devices, their pose in the room, and the part of the body of each sensor."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, field

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.ports.tracker_port import TRACKER_KINDS, tracker_names
from mimics_app.world.components.bounds import NO_ROTATION, Point, Quaternion
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, register_system

__all__ = ["RoomPoints", "TrackerSpec", "TrackersSettings"]

_Name = Annotated[str, Meta(min_length=1, max_length=64)]


class RoomPoints(Component, frozen=True):
    """Points touched with a sensor: as reported by the tracker, and in the room."""

    seen: Annotated[
        list[Point],
        Meta(min_length=4, max_length=1000, description="Points as reported, in the application's axes [m]"),
    ]
    room: Annotated[list[Point], Meta(min_length=4, max_length=1000, description="The same points in the room [m]")]


class TrackerSpec(Component, frozen=True):
    """One tracking device."""

    name: Annotated[_Name, Meta(description="Name in messages")]
    kind: Annotated[
        str,
        Meta(
            max_length=64,
            examples=[*TRACKER_KINDS],
            description="Protocol; scripted: a simulated person; pointer: mouse and gamepad; headset: the "
            "display's own head and hands; tape: a recording",
        ),
    ]
    address: Annotated[
        str,
        Meta(
            max_length=400,
            description="Serial port; TRACKER@HOST[:PORT] of vrpn; [HOST:]PORT of osc; LSL stream; file of a tape",
        ),
    ] = ""
    baud: Annotated[int, Meta(ge=1200, le=1_000_000, description="Baud rate of a serial line [bit/s]")] = 115200
    axes: Annotated[str, Meta(max_length=16, description="Room x, y, z as axes of the device: 'x,-z,y'")] = "x,y,z"
    unit: Annotated[
        Literal["m", "cm", "mm", "inch"], Meta(description="Unit of the positions of vrpn, osc and lsl")
    ] = "m"
    roles: Annotated[
        dict[str, _Name],
        Meta(max_length=64, description="Part of the body by sensor: head, chest, hand_left, hand_right"),
    ] = field(default_factory=dict)
    calibration: Annotated[RoomPoints | None, Meta(description="Absent: the device's frame is the room's")] = None
    offset: Annotated[Point, Meta(description="Position of the part of the body in the sensor's frame [m]")] = (0, 0, 0)
    turn: Annotated[
        Quaternion, Meta(description="Orientation of the part of the body in the sensor's frame, x y z w")
    ] = NO_ROTATION


class TrackersSettings(Component, frozen=True):
    """All tracking devices; of two for one part of the body the first counts."""

    devices: Annotated[list[TrackerSpec], Meta(max_length=16, description="In order of precedence")] = field(
        default_factory=list
    )
    tape: Annotated[bool, Meta(description="True: every report is kept in the run folder, as trackers.jsonl")] = False


def _check_trackers(settings: TrackersSettings, scene: CheckedScene) -> list[Issue]:
    """Return the devices of a kind that neither the program nor an installed package has."""
    kinds = {f"/systems/trackers/devices/{n}/kind": spec.kind for n, spec in enumerate(settings.devices)}
    known = TRACKER_KINDS if {*kinds.values()} <= {*TRACKER_KINDS} else tracker_names()
    return scene.check_names(kinds, "there is no tracker", known)


register_system("trackers", TrackersSettings, _check_trackers)
