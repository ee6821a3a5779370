"""Construction of the trackers of a session from its scene."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.ports.tracker_port import TrackerSource
from mimics_app.inputs.trackers.calibration import UNITS, Calibration, axis_map, fit_room
from mimics_app.inputs.trackers.hub import MountedTracker, TrackerHub
from mimics_app.inputs.trackers.tape import TapeTracker, TapeWriter
from mimics_app.inputs.trackers.tracker_kinds import TrackerRequest, build_tracker
from mimics_app.maths.poses import pose_from_parts
from mimics_app.world.components.trackers import TrackerSpec, TrackersSettings
from mimics_app.world.files.reading.paths import PathFault
from mimics_app.world.files.scene.scene import Scene

__all__ = ["make_hub", "replayed_hub"]

_TAPE = "trackers.jsonl"
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
    mounted = []
    for number, spec in enumerate(settings.devices):
        pointer = f"/systems/trackers/devices/{number}"
        mounted.append(_mount(scene, spec, _source(scene, spec, pointer, clock, seed), pointer))
    tape = TapeWriter(folder / _TAPE) if folder is not None and settings.tape and mounted else None
    return TrackerHub(mounted, tape)


def replayed_hub(scene: Scene, clock: Clock, seed: int, folder: Path) -> tuple[TrackerHub, list[str]]:
    """Return the trackers of a recorded session, and the names of those whose poses were not recorded.

    No device is opened: a scripted person moves again, and all others are played from the tape of the run folder.

    Args:
        scene: The scene.
        clock: Clock of the replay.
        seed: Seed of the session.
        folder: The run folder.

    Raises:
        SceneError: Axes, calibration or tape of a tracker are faulty.
    """
    settings, tape = scene.system(TrackersSettings) or TrackersSettings(), folder / _TAPE
    mounted, left_out = [], []
    for number, spec in enumerate(settings.devices):
        pointer = f"/systems/trackers/devices/{number}"
        source = _source(scene, spec, pointer, clock, seed)
        if not source.simulated and not tape.is_file():
            left_out.append(spec.name)
            continue
        played = source if source.simulated else TapeTracker(spec.name, tape)
        mounted.append(_mount(scene, spec, played, pointer))
    return TrackerHub(mounted), left_out


def _source(scene: Scene, spec: TrackerSpec, pointer: str, clock: Clock, seed: int) -> TrackerSource:
    try:
        return build_tracker(TrackerRequest(spec, scene, clock, seed))
    except PathFault as fault:
        raise SceneError(scene.issue(f"{pointer}/address", fault.what, fault.fix)) from None


def _mount(scene: Scene, spec: TrackerSpec, source: TrackerSource, pointer: str) -> MountedTracker:
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
    return MountedTracker(source, spec.roles, axes, UNITS[spec.unit], calibration, offset)
