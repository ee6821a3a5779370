"""How many triangles the shipped scenes send to the driver, from their own cameras."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from mimics_app.app.picture.picture import Picture, picture_quality
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.resources import root
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.world.scene.file import build_world

CEILING = 80_000
HIGHER = {"city_walk": 100_000, "avatar_gallery": 100_000}
"""A town; and nine people side by side."""

SCENES = root() / "scenes"


def triangles_of(file: Path, surface: Surface) -> int:
    """Of its first frame at full quality, shadow maps included; how large the picture is does not matter to levels."""
    scene = load_checked_scene(file)
    world = build_world(scene)
    world.update()
    picture = Picture(surface, scene, world, picture_quality(scene, "training"))
    triangles = picture.renderer.draw(picture.views).triangles
    picture.renderer.release()
    return triangles


def too_many(files: Sequence[Path]) -> dict[str, int]:
    """Scenes that send more than they may."""
    with create_surface("egl", (64, 36)) as surface:
        counted = {file.stem: triangles_of(file, surface) for file in files}
    assert all(count > 100 for count in counted.values())
    return {name: count for name, count in counted.items() if count > HIGHER.get(name, CEILING)}


def test_no_shipped_scene_sends_more_triangles_than_it_may():
    assert too_many(sorted(SCENES.glob("*.json"))) == {}


@pytest.mark.slow
def test_no_shipped_example_sends_more_triangles_than_it_may():
    assert too_many(sorted((SCENES / "examples").glob("*.json"))) == {}
