"""Component type of a reference of the robot's joints: curves over a cycle, their pace, and the guidance along them."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.loop.reference_rows import MAX_CURVE
from mimics_app.world.components.bounds import Share
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["JointCurve", "JointReference"]

_Joint = Annotated[float, Meta(ge=-100, le=100)]
_Rate = Annotated[float, Meta(gt=0, le=10)]
_FEWEST_KNOTS = 4
"""Smallest number of knots of a table."""


class JointCurve(Component, frozen=True):
    """Reference of one joint over a cycle: a Fourier series, a table, or a recorded trajectory."""

    joint: Annotated[str, Meta(max_length=80, description="Name of the joint, as the device has it, e.g. hip")]
    kind: Annotated[
        Literal["series", "cubic", "linear"],
        Meta(description="Meaning of `values`: Fourier series, or table with cubic or linear interpolation"),
    ] = "series"
    values: Annotated[
        Annotated[tuple[_Joint, ...], Meta(min_length=1, max_length=MAX_CURVE)] | None,
        Meta(description="Series: mean, then cosine and sine of every harmonic; table: values at even phases [m, rad]"),
    ] = None
    file: Annotated[
        str | None,
        Meta(description="Recorded trajectory instead: .csv with columns t [s] and the name of the joint, one cycle"),
    ] = None
    shift: Annotated[float, Meta(ge=-1, le=1, description="How much later the joint's cycle begins [cycles]")] = 0.0
    rest: Annotated[_Joint, Meta(description="Joint while it stands [m, rad]")] = 0.0
    guidance: Annotated[Share, Meta(description="Share of the guidance that this joint gets [-]")] = 1.0


@component("joint_reference", limit=100, once=True)
class JointReference(Component, frozen=True):
    """Reference of the robot's joints over a cycle, and the guidance towards it."""

    body_height: Annotated[
        Annotated[float, Meta(ge=0.8, le=2.3)] | None,
        Meta(description="Body height [m]: hip and knee of every leg walk; absent: `curves` says how joints move"),
    ] = None
    curves: Annotated[
        tuple[JointCurve, ...], Meta(max_length=8, description="Curves of single joints; they replace those of a walk")
    ] = ()
    cadence: Annotated[
        float,
        Meta(ge=0, le=3, description="Cycles per second [1/s]; 0: natural for the speed, or as recorded"),
    ] = 0.0
    speed: Annotated[float, Meta(ge=0, le=3, description="Walking speed [m/s]")] = 0.5
    amplitude: Annotated[Share, Meta(description="Share of the movement; 0: the joints stand [-]")] = 1.0
    guidance: Annotated[Share, Meta(description="Share of the pull towards the reference [-]")] = 1.0
    cadence_rate: Annotated[_Rate, Meta(description="Largest rate of the cadence [1/s^2]")] = 0.25
    speed_rate: Annotated[_Rate, Meta(description="Largest rate of the speed [m/s^2]")] = 0.25
    amplitude_rate: Annotated[_Rate, Meta(description="Largest rate of the amplitude: start and stop [1/s]")] = 0.4
    guidance_rate: Annotated[_Rate, Meta(description="Largest rate of the guidance [1/s]")] = 0.5


def _check_curve(curve: JointCurve, pointer: str, scene: CheckedScene) -> list[Issue]:
    if (curve.values is None) == (curve.file is None):
        return [scene.issue(pointer, "needs either values or a file", "give exactly one of the two")]
    if curve.file is not None:
        return scene.check_file(f"{pointer}/file", curve.file)
    count = len(curve.values or ())
    if curve.kind == "series" and count % 2 == 0:
        what = f"{count} numbers; a series has its mean and two for every harmonic"
        return [scene.issue(f"{pointer}/values", what, "give an odd number of them")]
    if curve.kind != "series" and count < _FEWEST_KNOTS:
        return [scene.issue(f"{pointer}/values", f"{count} values; a table has at least {_FEWEST_KNOTS}")]
    return []


def _check(reference: JointReference, pointer: str, scene: CheckedScene) -> list[Issue]:
    if reference.body_height is None and not reference.curves:
        return [scene.issue(pointer, "moves no joint", "give body_height for a walk, or curves")]
    names = [curve.joint for curve in reference.curves]
    issues = [
        scene.issue(f"{pointer}/curves/{i}/joint", f'a second curve of "{name}"', "keep one")
        for i, name in enumerate(names)
        if name in names[:i]
    ]
    for i, curve in enumerate(reference.curves):
        issues += _check_curve(curve, f"{pointer}/curves/{i}", scene)
    recorded = any(curve.file is not None for curve in reference.curves)
    if reference.cadence == 0.0 and reference.body_height is None and not recorded:
        issues.append(scene.issue(f"{pointer}/cadence", "is 0, and nothing says how long a cycle lasts", "give it"))
    return issues


register_check("joint_reference", _check)
