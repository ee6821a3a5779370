"""Construction of the trackers of a session from its scene."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.tracker_port import TrackerSource
from mimics_app.inputs.trackers.calibration import UNITS, Calibration, axis_map, fit_room
from mimics_app.inputs.trackers.headset_tracker import HeadsetTracker
from mimics_app.inputs.trackers.hub import Placed, TrackerHub
from mimics_app.inputs.trackers.pointer_tracker import PointerTracker
from mimics_app.inputs.trackers.scripted_person import ScriptedPerson
from mimics_app.inputs.trackers.tape import TapeTracker, TapeWriter
from mimics_app.maths.poses import pose_from_parts
from mimics_app.world.components.trackers import TrackerSpec, TrackersSettings
from mimics_app.world.scene.paths import PathFault, find_file
from mimics_app.world.scene.scene import Scene

__all__ = ["TAPE", "make_hub"]

TAPE = "trackers.jsonl"
"""Name of the tape in a run folder."""


def make_hub(scene: Scene, clock: Clock, seed: int, folder: Path | None = None) -> TrackerHub:
    """Return the trackers of a scene, not started yet.

    Args:
        scene: The scene.
        clock: The session's clock.
        seed: Seed of a scripted person.
        folder: Folder for the tape that the scene requests; None: no tape.

    Raises:
        SceneError: Axes, calibration or tape of a tracker are faulty.
    """
    settings = scene.system(TrackersSettings) or TrackersSettings()
    placed = []
    for number, spec in enumerate(settings.devices):
        pointer = f"/systems/trackers/devices/{number}"
        placed.append(_place(scene, spec, _source(scene, spec, pointer, clock, seed), pointer))
    tape = TapeWriter(folder / TAPE) if folder is not None and settings.tape and placed else None
    return TrackerHub(placed, tape)


def _source(scene: Scene, spec: TrackerSpec, pointer: str, clock: Clock, seed: int) -> TrackerSource:
    if spec.kind == "tape":
        try:
            return TapeTracker(spec.name, find_file(spec.address, scene.path.parent, scene.root))
        except PathFault as fault:
            raise SceneError(scene.issue(f"{pointer}/address", fault.what, fault.fix)) from None
    if spec.kind == "scripted":
        return ScriptedPerson(spec.name, seed)
    if spec.kind in ("pointer", "headset"):
        return PointerTracker(spec.name) if spec.kind == "pointer" else HeadsetTracker(spec.name)
    return _connected(spec, clock)


def _connected(spec: TrackerSpec, clock: Clock) -> TrackerSource:
    """Return a tracker on a serial line or a network; its libraries are imported only where a scene has it."""
    if spec.kind in ("fastrak", "flock"):
        from mimics_app.inputs.trackers.serial_tracker import fastrak, flock_of_birds

        return (fastrak if spec.kind == "fastrak" else flock_of_birds)(spec.name, spec.address, spec.baud, clock)
    if spec.kind == "vrpn":
        from mimics_app.inputs.trackers.vrpn import VrpnTracker

        return VrpnTracker(spec.name, spec.address, clock)
    if spec.kind == "osc":
        from mimics_app.inputs.trackers.osc import OscTracker

        return OscTracker(spec.name, spec.address, clock)
    from mimics_app.inputs.trackers.lsl import LslTracker

    return LslTracker(spec.name, spec.address, clock)


def _place(scene: Scene, spec: TrackerSpec, source: TrackerSource, pointer: str) -> Placed:
    try:
        axes = axis_map(spec.axes)
    except UsageError as error:
        raise SceneError(scene.issue(f"{pointer}/axes", error.what, error.fix)) from None
    try:
        room = spec.calibration
        calibration = Calibration.none() if room is None else fit_room(room.seen, room.room)
    except UsageError as error:
        raise SceneError(scene.issue(f"{pointer}/calibration", error.what, error.fix)) from None
    offset = pose_from_parts(spec.offset, spec.turn)
    return Placed(source, spec.roles, axes, UNITS[spec.unit], calibration, offset)
