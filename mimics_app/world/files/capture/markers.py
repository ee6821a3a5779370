"""Points of a body from optical markers: joint centres, and points of pelvis, chest and head.

Labels are those of the usual sets (Plug-in Gait, ISB, OpenSim's gait models) and of joint centres that other programs
compute. Hip joints come from the pelvis by the regression of Bell, Pedersen & Brand 1990 (shares of the distance of the
front spines: 0.36 to the side, 0.19 behind, 0.30 below).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.table_file import read_table_file
from mimics_app.world.files.capture.c3d_file import MarkerTake

__all__ = ["BodyPoints", "find_points"]


_LABELS = read_table_file(Path(__file__).with_suffix(".json"), dict[str, dict[str, tuple[str, ...]]])
_SIDED, _MIDDLE = _LABELS["sided"], _LABELS["middle"]
_FROM_MIDDLES = ("Knee", "Ankle", "Elbow", "Wrist")
_HALF_KNEE, _HALF_ANKLE = 0.050, 0.036
"""Half the width of a knee and an ankle plus half a marker [m], where only the outer side has a marker."""
_ASIDE, _BEHIND, _BELOW = 0.36, 0.19, 0.30


@dataclass(frozen=True, eq=False)
class BodyPoints:
    """Trajectories of points of a body.

    Attributes:
        points: Positions by name, "leftKnee", "nape" ...; [m], without gaps, [frames, 3].
        report: Report of what was found and guessed.
    """

    points: dict[str, F8]
    report: tuple[str, ...]

    def has(self, *names: str) -> bool:
        """True when all named points exist."""
        return all(name in self.points for name in names)

    def middle(self, *names: str) -> F8:
        """Return the mean of some points, [frames, 3]."""
        return np.asarray(np.mean([self.points[name] for name in names], axis=0))


def find_points(take: MarkerTake, file: str) -> BodyPoints:
    """Find the points of a body among markers.

    Raises:
        SceneError: legs or shoulders are missing; the message names all missing points.
    """
    labels = {_bare(name): number for number, name in enumerate(take.names)}
    found, report = dict[str, F8](), list(take.report)
    wanted = {f"{word}{part}": [letter + label for label in names] + [word.upper() + label for label in names]
              for part, names in _SIDED.items() for letter, word in (("L", "left"), ("R", "right"))}  # fmt: skip
    for name, names in {**wanted, **_MIDDLE}.items():
        number = next((labels[label] for label in names if label in labels), None)
        if number is not None and np.isfinite(take.places[:, number]).all(axis=1).any():
            found[name], gaps = _filled(take.places[:, number])
            if gaps:
                report.append(f"{take.names[number]} is not seen in {gaps} frames: filled along a straight line")
    body = BodyPoints(found, ())
    _add_hips(body, report)
    _add_middles(body, report)
    _check(body, file)
    used = sum(1 for name in found if name in wanted or name in _MIDDLE)
    report.append(f"{used} points of the body found among the markers")
    return BodyPoints(found, tuple(report))


def _bare(name: str) -> str:
    """Return a label without the subject's prefix, reduced to letters and digits."""
    return re.sub(r"[^A-Z0-9]", "", name.rsplit(":", 1)[-1].upper())


def _filled(places: F8) -> tuple[F8, int]:
    """Return positions with gaps filled linearly, and the number of filled frames."""
    seen = np.isfinite(places).all(axis=1)
    if seen.all():
        return places, 0
    frames = np.arange(len(places))
    filled = np.stack([np.interp(frames, frames[seen], places[seen, k]) for k in range(3)], axis=1)
    return filled, int((~seen).sum())


def _add_hips(body: BodyPoints, report: list[str]) -> None:
    """Add the sacrum, and hip joints where the file has none."""
    points = body.points
    if body.has("leftBehind", "rightBehind"):
        points["sacrum"] = body.middle("leftBehind", "rightBehind")
    if body.has("leftHip", "rightHip") or not body.has("leftFront", "rightFront", "sacrum"):
        return
    across = points["leftFront"] - points["rightFront"]
    wide = np.linalg.norm(across, axis=1, keepdims=True)
    front = body.middle("leftFront", "rightFront")
    x = across / wide
    ahead = front - points["sacrum"]
    ahead = ahead - (ahead * x).sum(axis=1, keepdims=True) * x
    z = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
    down = -np.cross(z, x)
    for word, side in (("left", 1.0), ("right", -1.0)):
        points[f"{word}Hip"] = front + wide * (side * _ASIDE * x - _BEHIND * z + _BELOW * down)
    report.append("guessed: hip joints, from the pelvis by the regression of Bell, Pedersen & Brand 1990")


def _add_middles(body: BodyPoints, report: list[str]) -> None:
    """Add joint centres between two markers, or at a typical distance inwards of a single one."""
    points, alone = body.points, list[str]()
    for word, other in (("left", "right"), ("right", "left")):
        for part in _FROM_MIDDLES:
            outer, inner = f"{word}{part}Out", f"{word}{part}In"
            if f"{word}{part}" in points or outer not in points:
                continue
            if inner in points:
                points[f"{word}{part}"] = body.middle(outer, inner)
                continue
            half = {"Knee": _HALF_KNEE, "Ankle": _HALF_ANKLE}.get(part, 0.0)
            inwards = np.zeros(3)
            if half and body.has("leftHip", "rightHip"):
                inwards = points[f"{other}Hip"] - points[f"{word}Hip"]
                inwards = inwards / np.linalg.norm(inwards, axis=1, keepdims=True)
            points[f"{word}{part}"] = points[outer] + half * inwards
            alone.append(f"{word} {part.lower()}")
    if alone:
        report.append(f"guessed: middles of {', '.join(alone)}: only the outer side has a marker")


def _check(body: BodyPoints, file: str) -> None:
    needed = [f"{word}{part}" for part in ("Hip", "Knee", "Ankle", "Shoulder") for word in ("left", "right")]
    missing = [name for name in needed if name not in body.points]
    if missing:
        what = f"no marker shows where {', '.join(missing)} are"
        raise SceneError(Issue(file, "/POINT/LABELS", what, "labels as of Plug-in Gait: LASI, LKNE, LANK, LSHO ..."))
