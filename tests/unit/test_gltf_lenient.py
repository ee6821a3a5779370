"""Models with a fault that others draw are drawn with a note: a vertex without weights, keys of one time, points."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from mimics_app.app.viewer.playing import play_clip
from mimics_app.app.viewer.shown import open_shown
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.errors import SceneError
from mimics_app.world.content.motion.posing import posed_positions
from mimics_app.world.files.gltf.file import load_gltf
from tests.support.gltf_maker import POSITIONS, GltfMaker, write_gltf
from tests.support.skin_maker import add_clip, bar, turn


def posed(file: Path, at: float) -> np.ndarray:
    shown = open_shown(file)
    play_clip(shown, "bend", at, speed=0.0)
    body = next(iter(shown.world.motion.bodies.values()))
    (key,) = body.meshes
    return posed_positions(shown.world.meshes[key], body)


def weighted(folder: Path, name: str, weights: np.ndarray) -> Path:
    maker = bar()
    maker.more["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = maker.array(weights)
    add_clip(maker, "bend", [(2, "rotation", [0.0, 1.0], [turn("z", 0), turn("z", 70)], "LINEAR")])
    return write_gltf(folder / name, maker.document())


def test_a_vertex_without_weights_follows_the_joint_it_names_first(tmp_path: Path) -> None:
    count = bar().accessors[0]["count"]
    plain = np.tile(np.array([0.5, 0.5, 0, 0], "f4"), (count, 1))
    given, expected = plain.copy(), plain.copy()
    given[5], expected[5] = 0.0, [1.0, 0.0, 0.0, 0.0]
    files = [weighted(tmp_path, f"{n}.gltf", each) for n, each in enumerate((given, expected))]
    for at in (0.0, 0.6, 1.0):
        np.testing.assert_array_equal(posed(files[0], at), posed(files[1], at))
    notes = load_gltf(files[0]).notes
    assert any("/WEIGHTS_0: 1 vertex without a weight, the first is 5" in note for note in notes)
    assert not any("without a weight" in note for note in load_gltf(files[1]).notes)


@pytest.mark.parametrize("kind", ["STEP", "LINEAR", "CUBICSPLINE"])
@pytest.mark.parametrize("times", [[0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 1.0, 1.0], [0.0] * 4, [0, 1e6, 1e6, 2e6]])
def test_keys_of_one_time_are_a_jump_and_a_note(tmp_path: Path, kind: str, times: list[float]) -> None:
    places = np.zeros((4, 3, 3) if kind == "CUBICSPLINE" else (4, 3))
    middle = places[:, 1] if kind == "CUBICSPLINE" else places
    middle[:, 0] = [0.0, 0.0, 5.0, 5.0]
    maker = bar()
    add_clip(maker, "jump", [(2, "translation", times, places, kind)])
    model = load_gltf(write_gltf(tmp_path / "jump.gltf", maker.document()))
    same = int((np.diff(times) == 0.0).sum())
    keys = "1 key" if same == 1 else f"{same} keys"
    assert any(f"/input: {keys} with the time of the one before" in note for note in model.notes)
    (clip,) = model.clips
    assert clip.duration == pytest.approx(times[-1], abs=1e-5 + 1e-6 * times[-1])
    shown = open_shown(tmp_path / "jump.gltf")
    joint = shown.world.motion.animators
    for at, x in ((0.5, 0.0), (1.5, 5.0)) if times == [0.0, 1.0, 1.0, 2.0] else ():
        play_clip(shown, "jump", at, speed=0.0)
        place = next(iter(joint.values())).pose.translations[:, 0]
        assert np.isclose(place, x, atol=1e-5).any() and np.isfinite(place).all()


def test_a_model_of_points_says_why_there_is_nothing_to_see(tmp_path: Path) -> None:
    maker = GltfMaker()
    position = maker.array(POSITIONS)
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"mode": 0, "attributes": {"POSITION": position}}]}],
    }
    shown = open_shown(write_gltf(tmp_path / "points.gltf", maker.document()))
    with pytest.raises(SceneError, match=r"nothing to see: .*points and lines are not drawn"):
        Viewport._furnish(cast(Any, SimpleNamespace(studio=None)), shown)
