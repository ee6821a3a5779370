"""Builders of the trackers: built-in ones, and plug-ins by entry points of the group mimics_app.trackers.

The libraries of trackers on a serial line or a network are imported only where a scene has one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.plugins import PluginError
from mimics_app.contracts.ports.tracker_port import PLUGINS, TrackerSource
from mimics_app.inputs.trackers.polled_tracker import HeadsetTracker
from mimics_app.inputs.trackers.scripted_person import PointerTracker, ScriptedPerson
from mimics_app.inputs.trackers.tape import TapeTracker
from mimics_app.world.components.trackers import TrackerSpec
from mimics_app.world.files.reading.paths import find_file
from mimics_app.world.files.scene.scene import Scene

__all__ = ["BUILT_IN", "TrackerBuilder", "TrackerRequest", "build_tracker"]


@dataclass(frozen=True, slots=True)
class TrackerRequest:
    """Arguments of a tracker's builder.

    Attributes:
        spec: The scene's entry.
        scene: The scene, for files beside it.
        clock: The session's clock.
        seed: Seed of a simulated person.
    """

    spec: TrackerSpec
    scene: Scene
    clock: Clock
    seed: int


TrackerBuilder = Callable[[TrackerRequest], TrackerSource]
"""Type of the entry points of the group `mimics_app.trackers`; raises PathFault for a file that is not there."""


def _tape(request: TrackerRequest) -> TrackerSource:
    scene = request.scene
    return TapeTracker(request.spec.name, find_file(request.spec.address, scene.path.parent, scene.root))


def _scripted(request: TrackerRequest) -> TrackerSource:
    return ScriptedPerson(request.spec.name, request.seed)


def _pointer(request: TrackerRequest) -> TrackerSource:
    return PointerTracker(request.spec.name)


def _headset(request: TrackerRequest) -> TrackerSource:
    return HeadsetTracker(request.spec.name)


def _fastrak(request: TrackerRequest) -> TrackerSource:
    from mimics_app.inputs.trackers.serial_tracker import fastrak

    return fastrak(request.spec.name, request.spec.address, request.spec.baud, request.clock)


def _flock(request: TrackerRequest) -> TrackerSource:
    from mimics_app.inputs.trackers.serial_tracker import flock_of_birds

    return flock_of_birds(request.spec.name, request.spec.address, request.spec.baud, request.clock)


def _vrpn(request: TrackerRequest) -> TrackerSource:
    from mimics_app.inputs.trackers.vrpn import VrpnTracker

    return VrpnTracker(request.spec.name, request.spec.address, request.clock)


def _osc(request: TrackerRequest) -> TrackerSource:
    from mimics_app.inputs.trackers.osc import OscTracker

    return OscTracker(request.spec.name, request.spec.address, request.clock)


def _lsl(request: TrackerRequest) -> TrackerSource:
    from mimics_app.inputs.trackers.lsl import LslTracker

    return LslTracker(request.spec.name, request.spec.address, request.clock)


BUILT_IN: dict[str, TrackerBuilder] = {
    "fastrak": _fastrak,
    "flock": _flock,
    "vrpn": _vrpn,
    "osc": _osc,
    "lsl": _lsl,
    "scripted": _scripted,
    "pointer": _pointer,
    "headset": _headset,
    "tape": _tape,
}
"""Builders of the kinds of `tracker_port.TRACKER_KINDS`."""


def build_tracker(request: TrackerRequest) -> TrackerSource:
    """Build a tracker of a kind that exists.

    Raises:
        DeviceError: Its plug-in cannot be loaded.
        PathFault: Its file is not there.
    """
    kind = request.spec.kind
    if kind in BUILT_IN:
        return BUILT_IN[kind](request)
    try:
        builder = cast(TrackerBuilder, PLUGINS.load(kind))
    except PluginError as error:
        raise DeviceError(f'the tracker "{kind}" is not available: {error}') from error
    return builder(request)
