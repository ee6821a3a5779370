"""Headset files: panels, lenses and eyes, and the script of a simulated headset."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta, field

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.rendering.visual.displays.display_size import too_many_pixels
from mimics_app.world.components.bounds import Point, Quaternion
from mimics_app.world.components.registry import Component
from mimics_app.world.files.reading.struct_file import read_struct_file

__all__ = ["EyeSpec", "HeadsetSpec", "LensSpec", "PoseSpec", "StateSpec", "load_headset"]

_Tangent = Annotated[float, Meta(ge=-5.0, le=5.0)]
_Coefficients = tuple[Annotated[float, Meta(ge=0.0, le=2.0)], Annotated[float, Meta(ge=0.0, le=2.0)]]


class LensSpec(Component, frozen=True):
    """Coefficients k1, k2 of r (1 + k1 r^2 + k2 r^4) per colour, r in tangents from the lens's centre."""

    red: _Coefficients = (0.20, 0.05)
    green: _Coefficients = (0.21, 0.055)
    blue: _Coefficients = (0.22, 0.06)
    centre: Annotated[
        tuple[_Tangent, _Tangent], Meta(description="Centre of the lens, tangents from straight ahead")
    ] = (
        0.0,
        0.0,
    )


class EyeSpec(Component, frozen=True):
    """One eye of a headset."""

    tangents: Annotated[
        tuple[_Tangent, _Tangent, _Tangent, _Tangent],
        Meta(description="Tangents of the panel: left, right, bottom, top"),
    ]
    position: Annotated[Point, Meta(description="Position in the head's frame [m]")]
    rotation: Annotated[
        Quaternion, Meta(description="Rotation in the head's frame, x y z w; not 0 0 0 1 for canted panels")
    ] = (
        0.0,
        0.0,
        0.0,
        1.0,
    )
    lens: Annotated[LensSpec, Meta(description="Lens of a headset without a runtime")] = LensSpec()


class PoseSpec(Component, frozen=True):
    """Pose of a simulated head at a time."""

    t: Annotated[float, Meta(ge=0.0, le=1e5, description="Time [s]")]
    position: Annotated[Point, Meta(description="Displacement from rest [m]")] = (0.0, 0.0, 0.0)
    rotation: Annotated[Quaternion, Meta(description="Rotation, x y z w")] = (0.0, 0.0, 0.0, 1.0)


class StateSpec(Component, frozen=True):
    """A state that a simulated session enters before a frame, counted from the first one."""

    frame: Annotated[int, Meta(ge=0, le=10**7)]
    state: Literal["visible", "focused", "synchronized", "stopping", "loss_pending", "exiting"]


def _left() -> EyeSpec:
    return EyeSpec(tangents=(-0.944, 1.06, -1.1, 1.05), position=(-0.0315, 0.0, 0.0))


def _right() -> EyeSpec:
    return EyeSpec(tangents=(-1.06, 0.944, -1.1, 1.05), position=(0.0315, 0.0, 0.0))


class HeadsetSpec(Component, frozen=True):
    """A headset."""

    format: Annotated[Literal["mimics.headset/1"], Meta(description="Format of this file")] = "mimics.headset/1"
    pixels: Annotated[
        tuple[Annotated[int, Meta(ge=16, le=8192)], Annotated[int, Meta(ge=16, le=8192)]] | None,
        Meta(description="Resolution of each eye's panel; absent: as requested"),
    ] = None
    refresh_hz: Annotated[Literal[60, 72, 80, 90, 120], Meta(description="Refresh rate [Hz]")] = 90
    left: EyeSpec = field(default_factory=_left)
    right: EyeSpec = field(default_factory=_right)
    poses: Annotated[
        list[PoseSpec], Meta(max_length=100_000, description="Script of a simulated head, ordered by time")
    ] = field(default_factory=list)
    dropped: Annotated[
        list[Annotated[int, Meta(ge=0)]],
        Meta(max_length=100_000, description="Numbers of the frames that are displayed late"),
    ] = field(default_factory=list)
    states: Annotated[list[StateSpec], Meta(max_length=1000, description="Script of a simulated session's states")] = (
        field(default_factory=list)
    )


def load_headset(path: Path) -> HeadsetSpec:
    """Read a headset file.

    Raises:
        SceneError: all faults: schema, empty frusta, quaternions that are not of length 1, times out of order.
    """
    spec, file = read_struct_file(path, HeadsetSpec), str(path)
    issues = [issue for name in ("left", "right") for issue in _check_eye(getattr(spec, name), f"/{name}", file)]
    drawn = 2 * math.prod(spec.pixels or (0, 0))
    issues += [Issue(file, "/pixels", what, "give the pixels of one eye") for what in too_many_pixels(drawn)]
    for number, pose in enumerate(spec.poses):
        if number and pose.t <= spec.poses[number - 1].t:
            issues.append(Issue(file, f"/poses/{number}/t", "is not later than the one before", "order poses by time"))
        issues += _check_rotation(pose.rotation, f"/poses/{number}/rotation", file)
    if issues:
        raise SceneError(issues)
    return spec


def _check_eye(eye: EyeSpec, pointer: str, file: str) -> list[Issue]:
    left, right, bottom, top = eye.tangents
    issues = _check_rotation(eye.rotation, f"{pointer}/rotation", file)
    if not (left < right and bottom < top):
        issues.append(Issue(file, f"{pointer}/tangents", "is an empty frustum", "give left < right and bottom < top"))
    return issues


def _check_rotation(rotation: tuple[float, float, float, float], pointer: str, file: str) -> list[Issue]:
    if abs(float(np.linalg.norm(rotation)) - 1.0) <= 1e-3:
        return []
    return [Issue(file, pointer, "is not a rotation: its length is not 1", "give a unit quaternion x y z w")]
