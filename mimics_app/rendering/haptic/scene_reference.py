"""Reference of the joints of a scene: rows of the loop and SCENE fields from its component, and their checks."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import F8, Records
from mimics_app.contracts.errors import DeviceError, Issue, SceneError
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.reference_rows import CURVE, MAX_CURVE, CurveKind, GrowsWith
from mimics_app.maths.gait_series import (
    LONGEST_STEP,
    TERMS,
    knee_series,
    leg_length,
    natural_cadence,
    series_at,
    step_of,
    thigh_series,
)
from mimics_app.rendering.haptic.descriptors.joint_limits import joint_limits
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.world.components.joint_reference import JointCurve, JointReference
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SceneReference", "check_reference", "reference_of_scene", "sample_curve", "spline_bends", "walk_rows"]

_KINDS = {"series": CurveKind.SERIES, "cubic": CurveKind.CUBIC, "linear": CurveKind.LINEAR}
_HIP, _KNEE = "hip", "knee"
_LEFT = "left"
"""Begin of the names of joints of the left of two legs."""
_LATER = 0.5
"""How much later the left leg is [cycles]."""
_CLOSED = 0.02
"""Largest difference of first and last sample of a recorded cycle [m, rad]."""
_MOST_SAMPLES = 100_000
_PHASES = 400
"""Phases at which limits are checked."""


class SceneReference(NamedTuple):
    """Reference of a scene for the loop.

    Attributes:
        rows: CURVE records, one for each joint of the device; none without a reference.
        joints: Name of the joint of each row.
        fields: SCENE fields by name.
    """

    rows: Records
    joints: tuple[str, ...]
    fields: Mapping[str, float]


_NONE = SceneReference(np.zeros(0, CURVE), (), {})


def reference_of_scene(scene: Scene) -> SceneReference:
    """Return the reference of a scene's joints; without rows where it has none, or no known device.

    Raises:
        SceneError: A recorded trajectory cannot be read.
    """
    found = scene.first(JointReference)
    descriptor = _descriptor(scene)
    if found is None or descriptor is None:
        return _NONE
    _, _, pointer = scene.components(JointReference)[0]
    folder = scene.origins.locate(pointer).folder
    names = tuple(joint.name for joint in descriptor.joints)
    rows, period = _no_curves(len(names)) if found.body_height is None else walk_rows(names, found.body_height), 0.0
    for curve in found.curves:
        if curve.joint in names:
            period = max(period, _write_curve(rows[names.index(curve.joint)], curve, folder))
    return SceneReference(rows, names, _fields_of(found, period))


def _descriptor(scene: Scene) -> DeviceDescriptor | None:
    """Return the descriptor of the scene's device; an unknown device is reported elsewhere."""
    robot = scene.first(Robot)
    if robot is None:
        return None
    try:
        return descriptor_of(robot.device)
    except DeviceError:
        return None


def _fields_of(reference: JointReference, period: float) -> dict[str, float]:
    """Return the SCENE fields of a reference whose recorded cycle lasts `period` [s], 0 without one."""
    height = reference.body_height
    return {
        "reference_cadence": reference.cadence or (1.0 / period if period > 0.0 else 0.0),
        "reference_speed": reference.speed,
        "reference_amplitude": reference.amplitude,
        "guidance": reference.guidance,
        "cadence_rate": reference.cadence_rate,
        "speed_rate": reference.speed_rate,
        "amplitude_rate": reference.amplitude_rate,
        "guidance_rate": reference.guidance_rate,
        "natural_step": 0.0 if height is None else step_of(1.0, height),
        "longest_step": 0.0 if height is None else LONGEST_STEP * leg_length(height),
    }


def _no_curves(joints: int) -> Records:
    """Return CURVE records of joints without a reference."""
    rows = np.zeros(joints, CURVE)
    rows["guidance"] = 1.0
    return rows


def walk_rows(joints: Sequence[str], height: float) -> Records:
    """Return CURVE records of a walk.

    Args:
        joints: Names of the device's joints; those that end with "hip" or "knee" walk, of two legs the left one, whose
            names begin with "left", half a cycle later.
        height: Body height [m].
    """
    rows = _no_curves(len(joints))
    for row, name in zip(rows, joints, strict=True):
        _write_gait(row, name, height)
    return rows


def _write_gait(row: np.void, joint: str, height: float) -> None:
    """Write hip or knee of a walk to the row of a joint; others keep none."""
    if joint.endswith(_HIP):
        row["values"][:, :TERMS], row["grows_with"] = thigh_series(height), GrowsWith.STEP
    elif joint.endswith(_KNEE):
        row["values"][:, :TERMS], row["least"] = knee_series(height)
        row["grows_with"] = GrowsWith.SPEED
    else:
        return
    row["kind"], row["used"] = CurveKind.SERIES, TERMS
    row["shift"] = _LATER if joint.startswith(_LEFT) else 0.0


def _write_curve(row: np.void, curve: JointCurve, folder: Path) -> float:
    """Write a curve of a scene to a row; return the time of its recorded cycle [s], 0 where it is none."""
    period, kind = 0.0, _KINDS[curve.kind]
    if curve.file is None:
        values = np.array(curve.values, np.float64)
    else:
        values, period = _read_recorded(folder / curve.file, curve.joint)
        kind = CurveKind.CUBIC
    row["values"] = 0.0
    row["values"][0, : len(values)] = values
    if kind == CurveKind.CUBIC:
        row["values"][1, : len(values)] = spline_bends(values)
    row["kind"], row["used"], row["grows_with"], row["least"] = kind, len(values), GrowsWith.NOTHING, 0.0
    row["shift"], row["rest"], row["guidance"] = curve.shift, curve.rest, curve.guidance
    return period


def spline_bends(knots: F8) -> F8:
    """Return the second derivatives of the periodic cubic spline through even knots [per cycle^2], shape [n].

    The circulant equations m[k-1] + 4 m[k] + m[k+1] = 6 n^2 (y[k-1] - 2 y[k] + y[k+1]) are solved by Fourier transform.
    """
    count = len(knots)
    turn = 2.0 * np.cos(2.0 * np.pi * np.arange(count // 2 + 1) / count)
    spectrum = np.fft.rfft(knots) * 6.0 * count**2 * (turn - 2.0) / (turn + 4.0)
    return np.asarray(np.fft.irfft(spectrum, count))


def _read_recorded(file: Path, joint: str) -> tuple[F8, float]:
    """Return a recorded cycle of a joint at MAX_CURVE even phases [m, rad], and the time that it lasts [s].

    Raises:
        SceneError: The file is no table of t and this joint, its times do not rise, or the cycle is not closed.
    """
    t, q = _columns(file, ("t", joint))
    if len(t) < 3 or len(t) > _MOST_SAMPLES:
        raise _fault(file, f"{len(t)} samples; a recorded cycle has 3 to {_MOST_SAMPLES}")
    if not np.all(np.diff(t) > 0.0):
        raise _fault(file, "the times in column t do not rise")
    if abs(q[-1] - q[0]) > _CLOSED:
        raise _fault(file, f"column {joint} ends {q[-1] - q[0]:+.3f} from its begin", "cut it to exactly one cycle")
    period = float(t[-1] - t[0])
    wanted = t[0] + period * np.arange(MAX_CURVE) / MAX_CURVE
    drift = (q[-1] - q[0]) * (t - t[0]) / period
    return np.interp(wanted, t, q - drift), period


def _columns(file: Path, names: tuple[str, ...]) -> tuple[F8, ...]:
    """Return columns of a CSV file by name, shape [n] each."""
    try:
        rows = list(csv.reader(read_bytes(file, str(file)).decode("utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error):
        raise _fault(file, "is not a CSV file in UTF-8") from None
    header = [cell.strip().lower() for cell in rows[0]] if rows else []
    if missing := [name for name in names if name not in header]:
        raise _fault(file, f"line 1 lacks the column {', '.join(missing)}", f"begin with {','.join(names)}")
    places = [header.index(name) for name in names]
    try:
        table = np.array([[float(row[place]) for place in places] for row in rows[1:] if row], np.float64)
    except (ValueError, IndexError):
        raise _fault(file, f"a line does not hold numbers in the columns {', '.join(names)}") from None
    if table.size == 0 or not np.all(np.abs(table) < 1e6):
        raise _fault(file, f"the columns {', '.join(names)} hold no finite numbers")
    return tuple(table.T)


def _fault(file: Path, what: str, fix: str = "") -> SceneError:
    return SceneError(Issue(str(file), "", what, fix))


def check_reference(reference: JointReference, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of a reference against the scene's device: unknown joints, and motion beyond its limits."""
    descriptor = _descriptor(scene)
    if descriptor is None:
        return []
    names = [joint.name for joint in descriptor.joints]
    issues = [
        scene.issue(f"{pointer}/curves/{i}/joint", f'no joint is called "{curve.joint}"', f"name {', '.join(names)}")
        for i, curve in enumerate(reference.curves)
        if curve.joint not in names
    ]
    if reference.body_height is not None and not any(name.endswith((_HIP, _KNEE)) for name in names):
        device = scene.one(Robot)[1].device
        issues.append(scene.issue(f"{pointer}/body_height", f'"{device}" has no hip or knee', "use curves"))
    if issues:
        return issues
    try:
        made = reference_of_scene(scene)
    except SceneError as error:
        return error.issues
    return _check_limits(made, pointer, scene, descriptor)


def _check_limits(made: SceneReference, pointer: str, scene: Scene, descriptor: DeviceDescriptor) -> list[Issue]:
    """Check that every joint stays within its range, and below its largest velocity at the cadence of the scene."""
    try:
        limits = joint_limits(scene.one(Robot)[1], descriptor)
    except DeviceError:
        return []
    height_speed = made.fields["reference_speed"]
    cadence = made.fields["reference_cadence"] or _natural(made.fields)
    issues = []
    for j, (row, name) in enumerate(zip(made.rows, made.joints, strict=True)):
        if row["kind"] == CurveKind.NONE:
            continue
        curve = sample_curve(row, height_speed, 0.5 * height_speed / cadence if cadence > 0.0 else 0.0)
        least, most = min(curve.min(), row["rest"]), max(curve.max(), row["rest"])
        if least < limits.lowest[j] or most > limits.highest[j]:
            what = f"{name} goes from {least:.2f} to {most:.2f}; the device's range is {limits.lowest[j]:.2f} to "
            issues.append(scene.issue(pointer, what + f"{limits.highest[j]:.2f}", "move it less"))
        fastest = cadence * float(np.abs(np.gradient(curve, 1.0 / _PHASES)).max())
        if fastest > limits.velocity[j]:
            what = f"{name} moves at up to {fastest:.2f} per second; the device's limit is {limits.velocity[j]:.2f}"
            issues.append(scene.issue(pointer, what, "lower the cadence"))
    return issues


def _natural(fields: Mapping[str, float]) -> float:
    """Return the natural cadence [1/s] of SCENE fields with a walk; 0 without one."""
    unit = fields["longest_step"] / LONGEST_STEP
    return natural_cadence(fields["reference_speed"], unit / leg_length(1.0)) if unit > 0.0 else 0.0


def sample_curve(row: np.void, speed: float, step: float) -> F8:
    """Return the joint of a CURVE record over its cycle [m, rad], shape [_PHASES], at a speed [m/s] and a step [m]."""
    phase = np.arange(_PHASES) / _PHASES
    used = int(row["used"])
    if row["kind"] != CurveKind.SERIES:
        return np.asarray(np.interp(phase, np.arange(used) / used, row["values"][0, :used], period=1.0))
    grown = {GrowsWith.SPEED: speed, GrowsWith.STEP: step}.get(GrowsWith(int(row["grows_with"])), 0.0)
    u = math.hypot(grown, float(row["least"])) if row["grows_with"] != GrowsWith.NOTHING else 0.0
    return series_at(np.array([1.0, u, u * u]) @ row["values"][:, :used], phase)
