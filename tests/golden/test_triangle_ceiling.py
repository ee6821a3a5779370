"""How many triangles the shipped scenes send to the driver, from their own cameras."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from mimics_app.app.picture.picture import Picture, picture_quality
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.world.files.scene.file import build_world

CEILING = 80_000
HIGHER = {"city_walk": 100_000, "soccer": 100_000, "avatar_gallery": 100_000}
"""A town; two players and people on stands in it; and nine people side by side."""

SMALL_CEILING = 30_000
SMALL_HIGHER = {"city_walk": 70_000, "soccer": 90_000, "canyon_walk": 45_000}
"""Of a picture of 64 x 36: no body needs more than a triangle or two a pixel. Houses have no coarser forms; in the town
one's own body is before the camera."""

SCENES = root() / "scenes"


def triangles_of(file: Path) -> tuple[int, int]:
    """Of the first frame of 1280 x 720 pixels, and of one of 64 x 36, shadow maps at full quality included."""
    scene = load_checked_scene(file)
    world = build_world(scene)
    world.update()
    counts = []
    for size in ((1280, 720), (64, 36)):
        with create_surface("egl", size) as surface:
            picture = Picture(surface, scene, world, replace(picture_quality(scene, "training"), msaa=0))
            counts.append(picture.renderer.draw(picture.views).triangles)
            picture.renderer.release()
    return counts[0], counts[1]


def too_many(files: Sequence[Path]) -> dict[str, tuple[int, int]]:
    """Scenes that send more than they may."""
    counted = {file.stem: triangles_of(file) for file in files}
    assert all(min(counts) > 100 for counts in counted.values())
    return {
        name: (large, small)
        for name, (large, small) in counted.items()
        if large > HIGHER.get(name, CEILING) or small > SMALL_HIGHER.get(name, SMALL_CEILING)
    }


def test_no_shipped_scene_sends_more_triangles_than_it_may():
    assert too_many(sorted(SCENES.glob("*.json"))) == {}


@pytest.mark.slow
def test_no_shipped_example_sends_more_triangles_than_it_may():
    assert too_many(sorted((SCENES / "examples").glob("*.json"))) == {}
