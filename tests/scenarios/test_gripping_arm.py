"""The participant's arm: five finger pads touch what the hand holds."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.scenarios.parts.shown_hand import ShownHand
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world, load_scene

FINGERS = ("Thumb", "Index", "Middle", "Ring", "Little")
NEAR = 0.003
"""Largest distance of a pad from what it holds [m], either side of its surface."""


@pytest.fixture(scope="module")
def market() -> tuple[World, ShownHand]:
    scene = load_checked_scene(root() / "scenes" / "pick_and_place.json")
    world = build_world(scene)
    return world, ShownHand(scene, world)


def last_bones(world: World, names: tuple[str, ...]) -> dict[str, F8]:
    """Vertices of the last bone of each finger, world [m]: the skin is bent here by matrices, not by the renderer."""
    body = next(b for b in world.motion.bodies.values() if b.entity == world.find("own_arm/skin").index)
    assert body.binding is not None
    frame = world.find("own_arm/skin").world_matrix()
    found: dict[str, list[F8]] = {name: [] for name in names}
    joints = [world.find(f"own_arm/{name}Distal").index for name in names]
    for mesh in body.meshes.values():
        assert mesh.weights is not None
        palette = np.einsum("njab,nj->nab", body.rows[mesh.weights.joints], mesh.weights.weights)
        bent = np.einsum("nab,nb->na", palette, np.c_[mesh.positions, np.ones(len(mesh.positions))])
        share = mesh.weights.weights.max(axis=1)
        strongest = np.take_along_axis(mesh.weights.joints, mesh.weights.weights.argmax(axis=1)[:, None], 1)[:, 0]
        for name, joint in zip(names, joints, strict=True):
            rows = (np.asarray(body.binding.joints)[strongest] == joint) & (share > 0.5)
            found[name].append(bent[rows] @ frame[:3, :3].T + frame[:3, 3])
    return {name: np.vstack(rows) for name, rows in found.items()}


@pytest.mark.parametrize("radius", [0.030, 0.032, 0.036])
def test_every_pad_touches_the_ball_that_is_held(market: tuple[World, ShownHand], radius: float) -> None:
    world, hand = market
    place = np.array([-0.05, 0.2, 0.03])
    hand.show(place, radius)
    world.update()
    for name, points in last_bones(world, FINGERS).items():
        gap = np.linalg.norm(points - place, axis=1).min() - radius
        assert abs(gap) <= NEAR, f"{name}: {1000 * gap:.2f} mm"


def test_the_open_hand_is_wider_than_the_closed_one(market: tuple[World, ShownHand]) -> None:
    world, hand = market
    widths = []
    for gap in (hand.spec.closed, hand.spec.open):
        hand.show((0.0, 0.2, 0.0), gap)
        world.update()
        tips = last_bones(world, ("Thumb", "Middle"))
        widths.append(np.linalg.norm(tips["Thumb"].mean(axis=0) - tips["Middle"].mean(axis=0)))
    assert widths[1] - widths[0] > 0.04


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"arm": "ball", "fingers": ["ball", "ball"]}, "either two `fingers` or an `arm`"),
        ({}, "either two `fingers` or an `arm`"),
        ({"arm": "ball"}, 'no clip "grip"'),
        ({"arm": "bal"}, "ball"),
    ],
)
def test_a_hand_without_one_kind_of_fingers_is_refused(tmp_path: Path, parts: dict[str, object], said: str) -> None:
    ball = {"mesh": {"primitive": {"shape": "sphere", "radius": 0.1}}}
    entities = [{"id": "ball", "components": ball}, {"id": "hand", "components": {"grasping_hand": parts}}]
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "scenario": "none", "entities": entities}))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    assert said in str(caught.value) and "/grasping_hand" in str(caught.value)
