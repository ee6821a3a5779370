"""`mimics assets levels`: coarser forms written into a file, read back as the renderer will, and what is refused."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.world.content.meshes.primitives import sphere
from mimics_app.world.files.scene.model_world import load_model_world
from mimics_app.world.files.simplify.level_writer import write_levels

STONE = root() / "assets" / "models" / "touch" / "stone.glb"
PIXEL = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGP4z8DwHwAFAAH/iZk9HQAAAABJRU5ErkJggg=="


def write_ball(folder, **changes):
    """A ball in a .gltf with its buffer and picture beside it, on two nodes, and a line strip that is no surface."""
    ball = sphere(1.0, 24)
    indices = ball.indices.astype("<u4").tobytes()
    positions = ball.positions.astype("<f4").tobytes()
    (folder / "ball.bin").write_bytes(positions + indices)
    (folder / "skin.png").write_bytes(base64.b64decode(PIXEL))
    low, high = ball.positions.min(axis=0).tolist(), ball.positions.max(axis=0).tolist()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [3.0, 0.0, 0.0]}],
        "meshes": [
            {
                "name": "ball",
                "primitives": [
                    {"attributes": {"POSITION": 0}, "indices": 1, "material": 0},
                    {"attributes": {"POSITION": 0}, "mode": 3},
                ],
            }
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"uri": "skin.png"}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": len(ball.positions),
                "type": "VEC3",
                "min": low,
                "max": high,
            },
            {"bufferView": 1, "componentType": 5125, "count": len(ball.indices), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)},
        ],
        "buffers": [{"uri": "ball.bin", "byteLength": len(positions) + len(indices)}],
    }
    document |= changes
    file = folder / "ball.gltf"
    file.write_text(json.dumps(document))
    return file, ball.triangle_count


def test_levels_are_read_back_by_the_world(tmp_path):
    file, fine = write_ball(tmp_path)
    (levels,) = write_levels(file, tmp_path / "out.glb", (0.5, 0.1))
    assert levels.name == "ball"
    assert levels.triangles == (fine, fine // 2, fine // 10)
    assert 0.0 == levels.errors[0] < levels.errors[1] < levels.errors[2] < 0.3
    world = load_model_world(tmp_path / "out.glb")
    table = world.content.levels
    assert table.column("count").tolist() == [3, 3], "both nodes share the meshes"
    assert table.column("coverages")[0, :3] == pytest.approx(levels.coverages)
    assert levels.coverages[2] == 0.0, "the coarsest never vanishes"


def test_a_file_in_two_buffers_is_read_to_its_end(tmp_path):
    """Its views are moved into one buffer; those of the second one lie beyond the end of the first."""
    whole, fine = write_ball(tmp_path)
    document = json.loads(whole.read_text())
    data = (tmp_path / "ball.bin").read_bytes()
    start = document["bufferViews"][1]["byteOffset"]
    (tmp_path / "ball.bin").write_bytes(data[:start])
    (tmp_path / "more.bin").write_bytes(data[start:])
    views = [document["bufferViews"][0], document["bufferViews"][1] | {"buffer": 1, "byteOffset": 0}]
    parts = [{"uri": "ball.bin", "byteLength": start}, {"uri": "more.bin", "byteLength": len(data) - start}]
    file, _ = write_ball(tmp_path, bufferViews=views, buffers=parts)
    (tmp_path / "ball.bin").write_bytes(data[:start])
    (levels,) = write_levels(file, tmp_path / "out.glb", (0.5,))
    assert levels.triangles == (fine, fine // 2)


def test_a_level_is_shown_where_its_error_is_a_pixel(tmp_path):
    """At its coverage the ball's radius is sqrt(c w h / pi) px; its error there, error / radius of that, is 1."""
    file, _ = write_ball(tmp_path)
    (levels,) = write_levels(file, tmp_path / "out.glb", (0.4, 0.1), pixels=1.0)
    for error, coverage in zip(levels.errors[1:], levels.coverages, strict=False):
        assert error * np.sqrt(coverage * 1920 * 1080 / np.pi) == pytest.approx(1.0, rel=1e-3)
    (twice,) = write_levels(file, tmp_path / "out.glb", (0.4, 0.1), pixels=2.0)
    assert twice.coverages[0] == pytest.approx(4.0 * levels.coverages[0])


def test_what_has_levels_is_frozen_objects_and_so_is_what_gets_no_smaller(tmp_path):
    file, _ = write_ball(tmp_path)
    write_levels(file, tmp_path / "once.glb")
    assert write_levels(tmp_path / "once.glb", tmp_path / "twice.glb") == []
    assert load_model_world(tmp_path / "twice.glb").content.levels.column("count").tolist() == [4, 4]


def test_the_command_writes_a_file_and_says_its_levels(tmp_path, capsys):
    assert main(["assets", "levels", str(STONE), "--out", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    (mesh,) = answer["meshes"]
    assert len(mesh["triangles"]) == 4 and mesh["triangles"][3] < 0.07 * mesh["triangles"][0]
    assert (tmp_path / "stone_levels.glb").is_file()


def test_progress_has_a_step_for_each_level(tmp_path):
    steps = []
    write_levels(STONE, tmp_path / "stone.glb", (0.5, 0.2), progress=lambda share, what: steps.append((share, what)))
    assert [share for share, _ in steps] == [0.0, 0.5]
    assert "50%" in steps[0][1] and "20%" in steps[1][1]


def test_the_viewer_counts_the_finest_level_alone(tmp_path):
    file, _ = write_ball(tmp_path)
    write_levels(file, tmp_path / "levels.glb")
    assert load_model_world(tmp_path / "levels.glb").content.levels.column("count").tolist() == [4, 4]
    assert open_shown(tmp_path / "levels.glb").size == open_shown(file).size


@pytest.mark.parametrize("shares", [(), (1.2,), (0.2, 0.5), (0.5, 0.5), (0.0,), tuple(np.linspace(0.9, 0.1, 8))])
def test_shares_that_do_not_fall_are_refused(tmp_path, shares):
    file, _ = write_ball(tmp_path)
    with pytest.raises(ValueError, match="decreasing shares"):
        write_levels(file, tmp_path / "out.glb", shares)
    assert not (tmp_path / "out.glb").exists()


def test_a_broken_file_says_where(tmp_path):
    file, _ = write_ball(tmp_path, buffers=[{"uri": "ball.bin", "byteLength": 10}])
    with pytest.raises(SceneError, match="bufferViews/"):
        write_levels(file, tmp_path / "out.glb")
    assert not (tmp_path / "out.glb").exists()
