"""The body of a person as distance fields: trunk, arms and legs as blended lofts of the person's girths."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.fields import F8, Ball, Blend, Field, Loft, Mirrored
from assets.builders.avatars.person import Person
from assets.builders.avatars.skeleton import Skeleton, arm_axes

__all__ = ["NECK_BASE", "Flesh", "make_flesh", "make_neck"]

NECK_BASE = (0.815, 0.842, 0.853)
"""Height of the root of the neck in statures: before, beside, behind."""

_BLEND_TRUNK, _BLEND_LIMB, _BLEND_ALL = 0.055, 0.010, 0.038


@dataclass(frozen=True)
class Flesh:
    """Fields of the parts and of all together; arms and legs by side (1: left, -1: right)."""

    trunk: Field
    arms: dict[int, Field]
    legs: dict[int, Field]
    whole: Field


def _half_axes(girth: float, flat: float, power: float = 2.0) -> tuple[float, float]:
    """Return half width and half depth of a superellipse of a girth [m]; its depth is `flat` of its width."""
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    x = np.sign(np.cos(turn)) * np.abs(np.cos(turn)) ** (2.0 / power)
    z = flat * np.sign(np.sin(turn)) * np.abs(np.sin(turn)) ** (2.0 / power)
    half = girth / float(np.sqrt(np.diff(x) ** 2 + np.diff(z) ** 2).sum())
    return half, flat * half


def make_flesh(person: Person, bones: Skeleton) -> Flesh:
    """Return the fields of a person."""
    trunk = _trunk(person, bones)
    arms = {side: _arm(person, bones, side, word) for side, word in ((1, "left"), (-1, "right"))}
    legs = {side: _leg(person, bones, side, word) for side, word in ((1, "left"), (-1, "right"))}
    return Flesh(trunk, arms, legs, Mirrored(Blend([trunk, arms[1], legs[1]], _BLEND_ALL)))


def _trunk(person: Person, bones: Skeleton) -> Field:
    """Pelvis, waist, ribs, shoulders and neck."""
    body = person.body
    h, low, high = body.stature, 0.458, 0.848
    chest = body.chest - (0.55 * body.bust + 0.085 if body.woman else 0.02)
    wide_hip, narrow = (0.71, 0.74) if body.woman else (0.74, 0.76)
    rows = []
    for level, girth, flat, back in (
        (0.458, 0.52 * body.hip, 0.95, -0.012),
        (0.480, 0.86 * body.hip, 0.72, -0.014),
        (0.505, 0.945 * body.hip, wide_hip, -0.014),
        (0.525, 0.965 * body.hip, wide_hip, -0.010),
        (0.550, 0.5 * (0.95 * body.hip + 0.97 * body.hip), wide_hip, -0.006),
        (0.578, 0.55 * body.hip + 0.43 * body.waist, 0.72, 0.000),
        (0.610, (0.985 if body.woman else 0.99) * body.waist, narrow, 0.004),
        (0.640, (0.955 if body.woman else 0.98) * body.waist, narrow, 0.002),
        (0.672, 0.42 * body.waist + 0.55 * chest, 0.74, 0.000),
        (0.705, 0.945 * chest, 0.74, -0.002),
        (0.735, 0.965 * chest, 0.74, -0.006),
        (0.765, 0.94 * chest, 0.70, -0.012),
        (0.790, 0.80 * chest, 0.64, -0.020),
        (0.812, 0.57 * chest, 0.62, -0.026),
        (0.832, 0.92 * body.neck, 0.90, -0.030),
        (0.848, 0.66 * body.neck, 0.96, -0.028),
    ):
        rows.append(((level - low) / (high - low), *_half_axes(girth, flat, 2.3), 0.0, back))
    parts: list[Field] = [Loft((0.0, low * h, 0.0), (0.0, high * h, 0.0), rows, power=2.3), make_neck(person)]
    for side, word in ((1, "left"), (-1, "right")):
        parts += _sides_of_trunk(person, bones.place(f"{word}UpperArm"), side)
    if body.belly:
        parts.append(Ball((0.0, 0.595 * h, 0.050 + body.belly), (0.115, 0.095, 0.075)))
    return Blend(parts, _BLEND_TRUNK)


def make_neck(person: Person) -> Field:
    """Return the field of the neck alone."""
    body = person.body
    h, r = body.stature, body.neck / (2.0 * math.pi)
    rows = [
        (0.0, 1.08 * r, 1.10 * r, 0.0, 0.0),
        (0.4, 0.97 * r, 1.02 * r, 0.0, 0.0),
        (1.0, 0.97 * r, 1.03 * r, 0.0, 0.0),
    ]
    return Loft((0.0, 0.815 * h, -0.036), (0.0, 0.900 * h, -0.004), rows)


def _sides_of_trunk(person: Person, shoulder: F8, side: int) -> list[Field]:
    """Collarbone and slope of the shoulder, breast muscle or breast, shoulder blade, seat."""
    body, h = person.body, person.body.stature
    inner = np.array([side * 0.030, 0.838 * h, -0.036])
    outer = shoulder + np.array([side * 0.004, 0.012 if body.woman else 0.016, -0.004])
    thick = 0.027 if body.woman else 0.035
    slope = Loft(
        inner, outer, [(0.0, thick, 0.038, 0.0, 0.0), (0.5, thick, 0.044, 0.0, 0.0), (1.0, thick, 0.048, 0.0, 0.0)]
    )
    blade = Ball((side * 0.082, 0.760 * h, -0.088), (0.062, 0.080, 0.034))
    seat = Ball((side * 0.070, 0.502 * h, -0.068), (0.078, 0.082, 0.062 if body.woman else 0.056))
    if body.woman:
        size = 0.052 + 0.42 * body.bust
        breast = Ball((side * 0.082, 0.722 * h, 0.070 + 0.55 * body.bust), (size, 0.96 * size, 0.9 * size))
        return [slope, blade, seat, breast]
    return [slope, blade, seat, Ball((side * 0.078, 0.745 * h, 0.066), (0.080, 0.054, 0.040))]


def _arm(person: Person, bones: Skeleton, side: int, word: str) -> Field:
    body = person.body
    along, back, thumb = arm_axes(side)
    shoulder, elbow, wrist = (bones.place(f"{word}{name}") for name in ("UpperArm", "LowerArm", "Hand"))
    r, w = body.biceps / (2.0 * math.pi), body.wrist / (2.0 * math.pi)
    f = 0.5 * (r + w) * (1.13 if not body.woman else 1.08)
    upper = [
        (0.0, 0.98 * r, 1.12 * r, 0.0, 0.0), (0.22, 1.00 * r, 1.14 * r, 0.0, 0.0),
        (0.5, 0.94 * r, 1.07 * r, 0.0, 0.002),
        (0.78, 0.84 * r, 0.92 * r, 0.0, 0.0), (1.0, 0.83 * r, 0.86 * r, 0.0, -0.002),
    ]  # fmt: skip
    lower = [
        (0.0, 0.83 * r, 0.86 * r, 0.0, -0.002), (0.10, 1.00 * f, 0.98 * f, 0.0, 0.0),
        (0.26, 1.03 * f, 1.03 * f, 0.0, 0.003),
        (0.5, 0.88 * f, 0.93 * f, 0.0, 0.002), (0.8, 0.85 * w, 1.10 * w, 0.0, 0.0), (1.0, 0.77 * w, 1.16 * w, 0.0, 0.0),
    ]  # fmt: skip
    cap = shoulder + 0.020 * along + (0.004 if body.woman else 0.008) * back
    size = 1.10 * r
    return Blend(
        [
            Loft(shoulder, elbow, upper, thumb),
            Loft(elbow, wrist + 0.02 * along, lower, thumb),
            Ball(cap, (1.06 * size, size, size), np.array([along, back, thumb])),
        ],
        _BLEND_LIMB,
    )


def _leg(person: Person, bones: Skeleton, side: int, word: str) -> Field:
    body = person.body
    hip, knee, ankle = (bones.place(f"{word}{name}") for name in ("UpperLeg", "LowerLeg", "Foot"))
    t, c, a = (girth / (2.0 * math.pi) for girth in (1.06 * body.thigh, body.calf, body.ankle))
    k = 0.5 * (0.585 * t + 1.0 * c)
    upper = [
        (0.0, 0.93 * t, 1.00 * t, -0.006 * side, -0.004), (0.2, 0.99 * t, 1.02 * t, -0.004 * side, 0.0),
        (0.45, 0.88 * t, 0.93 * t, 0.0, 0.006),
        (0.70, 0.70 * t, 0.77 * t, 0.0, 0.006), (0.88, 0.98 * k, 1.02 * k, 0.0, 0.004),
        (1.0, 0.98 * k, 1.03 * k, 0.0, 0.004),
    ]  # fmt: skip
    lower = [
        (0.0, 0.98 * k, 1.03 * k, 0.0, 0.004), (0.12, 0.93 * c, 1.00 * c, 0.0, -0.004),
        (0.28, 0.96 * c, 1.05 * c, 0.0, -0.012),
        (0.45, 0.86 * c, 0.94 * c, 0.0, -0.010), (0.70, 0.62 * c, 0.70 * c, 0.0, -0.004),
        (0.9, 0.94 * a, 1.06 * a, 0.0, 0.002),
        (1.0, 0.96 * a, 1.10 * a, 0.0, 0.002),
    ]  # fmt: skip
    top = hip + np.array([side * 0.004, 0.03, -0.004])
    return Blend([Loft(top, knee, upper), Loft(knee, ankle - [0.0, 0.02, 0.0], lower)], _BLEND_LIMB)
