"""What the GLB writer writes, our reader and an independent one read back; pictures are PNGs to another decoder."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

from assets.builders.kit.png_writer import write_indexed_png
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.gltf.writer import GltfWriter, MeshPart

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]], np.float32)


def part(vertices: int = 3) -> MeshPart:
    positions = np.resize(CORNERS, (vertices, 3)).astype(np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (vertices, 1))
    shades = np.tile(np.array([128, 128, 128, 255], np.uint8), (vertices, 1))
    return MeshPart(positions, normals, positions[:, :2].copy(), shades, np.array([0, 1, vertices - 1], np.uint32))


def written(tmp_path: Path, vertices: int = 3) -> Path:
    writer = GltfWriter("test")
    picture = writer.add_picture("grey", write_indexed_png(np.zeros((4, 5), np.uint8), np.array([[9, 9, 9]], np.uint8)))
    opaque = writer.add_material("wall", colour=(0.5, 0.25, 0.125, 1.0), texture=picture, roughness=0.75)
    cut = writer.add_material("leaf", mask=0.25, unlit=True)
    shared = writer.add_part(part(vertices))
    fine, coarse = (writer.add_mesh(name, [(shared, material)]) for name, material in (("fine", opaque), ("low", cut)))
    group = writer.add_node("group", translation=(1.0, 2.0, 3.0))
    node = writer.add_node("house", parent=group, mesh=fine, rotation=(0.0, 1.0, 0.0, 0.0), extras={"mimics": {"x": 1}})
    writer.add_detail_levels(node, [coarse], (0.5, 0.0))
    return writer.write(tmp_path / "new" / "model.glb")


def test_our_reader_reads_it_back(tmp_path: Path) -> None:
    model = load_gltf(written(tmp_path))
    group, house, low = model.nodes
    assert (group.translation, group.children, house.parent) == ((1.0, 2.0, 3.0), [1], 0)
    assert (house.rotation, house.extras["mimics"], low.parent) == ((0.0, 1.0, 0.0, 0.0), {"x": 1}, None)
    assert model.roots == [0]
    mesh = model.meshes[0].primitives[0].mesh
    assert np.array_equal(mesh.positions, CORNERS)
    assert mesh.colours is not None
    assert mesh.colours[0] == pytest.approx([128 / 255] * 3 + [1.0])
    wall, leaf = model.materials
    assert (wall.base_colour, wall.roughness, wall.metallic) == ((0.5, 0.25, 0.125, 1.0), 0.75, 0.0)
    assert (leaf.alpha_mode, leaf.alpha_cutoff, leaf.technique) == ("mask", 0.25, "unlit")
    assert model.raw["nodes"][1]["extensions"]["MSFT_lod"] == {"ids": [2]}
    assert model.textures["texture0"].pixels.shape == (4, 5, 4)


def test_another_reader_reads_it_too(tmp_path: Path) -> None:
    import trimesh

    scene = trimesh.load_scene(written(tmp_path))
    found = [mesh for mesh in scene.geometry.values() if len(mesh.faces) == 1]
    assert found
    assert np.array_equal(np.sort(found[0].vertices, axis=0), np.sort(CORNERS, axis=0))


def test_the_same_parts_make_the_same_bytes(tmp_path: Path) -> None:
    assert written(tmp_path / "a").read_bytes() == written(tmp_path / "b").read_bytes()


@pytest.mark.parametrize(("vertices", "code"), [(65_534, 5123), (65_535, 5125)])
def test_indices_are_short_while_they_can_be(tmp_path: Path, vertices: int, code: int) -> None:
    model = load_gltf(written(tmp_path, vertices))
    accessor = model.raw["accessors"][model.raw["meshes"][0]["primitives"][0]["indices"]]
    assert accessor["componentType"] == code
    assert model.meshes[0].primitives[0].mesh.indices.tolist() == [0, 1, vertices - 1]


@pytest.mark.parametrize("size", [(1, 1), (7, 300), (300, 301)])
def test_png_is_read_by_pillow(size: tuple[int, int]) -> None:
    """The largest needs several stored blocks of 65,535 bytes."""
    from PIL import Image

    indices = (np.arange(size[0] * size[1]) % 251).astype(np.uint8).reshape(size)
    palette = np.stack([np.arange(251), 250 - np.arange(251), np.arange(251), np.full(251, 77)], axis=1).astype(
        np.uint8
    )
    with Image.open(io.BytesIO(write_indexed_png(indices, palette))) as picture:
        assert np.array_equal(np.array(picture.convert("RGBA")), palette[indices])


def test_png_refuses_what_no_palette_holds() -> None:
    with pytest.raises(ValueError, match="points past"):
        write_indexed_png(np.full((2, 2), 3, np.uint8), np.zeros((3, 3), np.uint8))
    with pytest.raises(ValueError, match="palette of shape"):
        write_indexed_png(np.zeros((2, 2), np.uint8), np.zeros((3, 5), np.uint8))
