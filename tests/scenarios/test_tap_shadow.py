"""The ball's shadow on the cord, in the light of the shipped scene, as the subject's eyes see it: at every tap."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest

from mimics_app.scenarios.avatar_cord import AvatarCord
from mimics_app.tasks.kinds.avatar_cord.spec import ConditionSpec, TapsSpec
from mimics_app.tasks.kinds.avatar_cord.tap_schedule import plan_taps
from mimics_app.world.files.scene.file import build_world, load_scene

ROOT = Path(__file__).parents[2]
BALL, HEAD = 0.022, 0.13
"""Radius of the ball, and of a sphere that holds a head [m]."""
GAPS = (0.005, 0.015, 0.03, 0.06, 0.09)


def _sphere_between(points: np.ndarray, way: np.ndarray, centre: np.ndarray, radius: float) -> np.ndarray:
    """Whether a ray from each point meets a sphere; `way` is of length 1."""
    to = centre - points
    along = (to * way).sum(axis=-1)
    return (along > 0.0) & (np.linalg.norm(to - along[..., None] * way, axis=-1) < radius)


class _Seen:
    """The cord, the sun and both heads of the shipped scene, and the surface around a place of the cord."""

    def __init__(self) -> None:
        scene = load_scene(ROOT / "scenes" / "avatar_cord.json")
        world = build_world(scene)
        world.update()
        self.played = AvatarCord(scene, world)
        sun = world.graph.world_matrix(world.find("sun").index)
        self.to_sun = sun[:3, 2] / np.linalg.norm(sun[:3, 2])  # a light shines along its -z
        self.cord, self.eye = self.played._cord, self.played.subject.head

    def shadow(self, share: float, theta: float, gap: float) -> float:
        """Area of the ball's shadow on the cord that the subject's eyes see [cm2]."""
        curve, radius = self.cord.curve, self.cord.shown_radius
        ball, _ = self.cord.place(share, theta, gap + BALL)
        s = np.linspace(max(share * curve.length - 0.12, 0.0), min(share * curve.length + 0.12, curve.length), 49)
        angles = np.linspace(-np.pi, np.pi, 48, endpoint=False)
        normals = np.array([curve.normal(each)[0] for each in s])
        out = np.cos(angles)[None, :, None] * normals[:, None] + np.sin(angles)[None, :, None] * curve.binormal
        points = curve.point(s)[:, None] + radius * out
        lit = (out @ self.to_sun > 0.0) & ~_sphere_between(points, self.to_sun, self.played.avatar.head, HEAD)
        lit &= ~_sphere_between(points, self.to_sun, self.played.subject.head, HEAD)
        sight = self.eye - points
        sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
        seen = ((out * sight).sum(axis=-1) > 0.0) & ~_sphere_between(points, sight, ball, BALL)
        dark = lit & seen & _sphere_between(points, self.to_sun, ball, BALL)
        return float(dark.sum() * (s[1] - s[0]) * (angles[1] - angles[0]) * radius * 1e4)


def test_every_tap_has_a_shadow_that_the_subject_sees() -> None:
    seen = _Seen()
    assert seen.to_sun[1] > 0.5, "the light comes from above"
    taps = plan_taps(TapsSpec(least_s=0.6, most_s=1.8), msgspec.convert({"duration_s": 60.0}, ConditionSpec), 5, 2)
    largest = [max(seen.shadow(tap.share, tap.theta, gap) for gap in GAPS) for tap in taps]
    assert len(largest) > 30 and min(largest) > 1.0


@pytest.mark.parametrize("theta", [-0.9, 0.0, 0.9])
def test_both_sides_and_all_of_the_cord_are_lit(theta: float) -> None:
    seen = _Seen()
    for share in np.linspace(0.2, 0.8, 5):
        assert max(seen.shadow(float(share), theta, gap) for gap in GAPS) > 1.0, share
