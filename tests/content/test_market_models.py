"""Models of the market: as shipped they are what their builder makes, and as large as what is touched there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assets.builders.catalogue import find_builder
from assets.builders.market import build, garden
from assets.builders.market.fruit import APPLE_RADIUS
from assets.builders.market.sculpt import pack_forms, pack_model
from mimics_app.contracts.system.resources import root
from mimics_app.world.files.gltf.file import GltfDocument, GltfMesh, load_gltf

FOLDER = root() / "assets" / "models" / "market"


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> dict[str, Path]:
    return {file.name: file for file in find_builder("market").write(tmp_path_factory.mktemp("market"), 1)}


def positions(document: GltfDocument) -> np.ndarray:
    return np.concatenate([part.mesh.positions for mesh in document.meshes for part in mesh.primitives])


def test_shipped_files_are_those_of_the_builder(built):
    """To a micrometre: sines may differ in their last digit from machine to machine; and as long, to the byte."""
    assert sorted(built) == sorted(file.name for file in FOLDER.iterdir() if file.suffix in (".glb", ".png"))
    for name, file in built.items():
        assert file.stat().st_size == (FOLDER / name).stat().st_size, name
        shipped, made = load_gltf(FOLDER / name), load_gltf(file)
        np.testing.assert_allclose(positions(shipped), positions(made), atol=1e-6, err_msg=name)


def test_another_seed_grows_another_garden(built, monkeypatch):
    """Of what does not grow the apple is made alone, of the trees only the coarsest form."""
    monkeypatch.setattr(build, "pack_model", lambda name, *more: pack_model(name, *more) if name == "apple" else b"")
    monkeypatch.setattr(build, "pack_forms", lambda name, *more: pack_forms(name, *more) if name == "meadow" else more)
    monkeypatch.setattr(garden, "_FORMS", garden._FORMS[-1:])
    other = build.compose(2)
    assert other["meadow.glb"] != built["meadow.glb"].read_bytes()
    assert other["apple.glb"] == built["apple.glb"].read_bytes()
    trees = [other[f"{name}.glb"][1]["tree"][0].part().positions for name in ("tree", "tree_round")]
    same = [garden.build_tree(number)[0].part().positions for number in range(4)]
    assert [[np.array_equal(tree, one) for one in same] for tree in trees] == [
        [False, False, True, False],
        [False, False, False, True],
    ]


def finest(document: GltfDocument) -> list[GltfMesh]:
    """The meshes without their coarser forms, which have the same names and come after them."""
    return list({mesh.name: mesh for mesh in reversed(document.meshes)}.values())


def triangles(meshes: list[GltfMesh]) -> list[int]:
    """Number of triangles of each mesh."""
    return [sum(part.mesh.triangle_count for part in mesh.primitives) for mesh in meshes]


def test_every_model_has_coarser_forms_and_the_meadow_has_tiles(built):
    """A tree's crown hides most of its balls' insides; of the meadow a view of 63 degrees sees less than half."""
    for name, file in built.items():
        assert len(load_gltf(file).meshes) > len(finest(load_gltf(file))), name
    tree = triangles(load_gltf(built["tree.glb"]).meshes)
    assert tree[0] < 16_000 and tree[-1] < 0.07 * tree[0]
    meadow = load_gltf(built["meadow.glb"])
    fine, both = triangles(finest(meadow)), triangles(meadow.meshes)
    assert len(fine) > 60 and len(both) == 2 * len(fine)
    assert max(fine) < 0.05 * sum(fine) and sum(both) < 1.15 * sum(fine)


def test_tiles_of_the_meadow_meet_in_common_vertices_in_both_forms(built):
    """Each vertex on the border of a coarse tile is one of the fine form: tiles of different forms leave no gaps."""
    tiles: dict[str, list[np.ndarray]] = {}
    for mesh in load_gltf(built["meadow.glb"]).meshes:
        tiles.setdefault(mesh.name, []).append(mesh.primitives[0].mesh.positions.astype(float))
    for name, (fine, coarse) in tiles.items():
        rings = np.hypot(*fine[at_sides(fine)].T[::2])
        away = np.hypot(*coarse.T[::2])
        border = at_sides(coarse) | np.isclose(away, rings.min(), atol=1e-6) | np.isclose(away, rings.max(), atol=1e-6)
        apart = np.linalg.norm(coarse[border, None] - fine[None], axis=2).min(axis=1)
        assert len(apart) >= 5 and apart.max() < 1e-5, name


def at_sides(at: np.ndarray) -> np.ndarray:
    """Which vertices of a tile are on its border with the tiles to both sides, of 16 sectors."""
    turn = np.arctan2(-at[:, 2], at[:, 0]) * 8.0 / np.pi
    return np.isclose(turn, np.round(turn), rtol=0.0, atol=1e-5)


@pytest.mark.parametrize(
    ("name", "size", "within"),
    [
        ("fence", (0.010, 0.100, 0.176), 0.004),
        ("crate", (0.075, 0.090, 0.085), 0.002),
        ("jug", (0.030, 0.046, 0.030), 0.013),  # the handle is not touched
        ("barrel", (0.072, 0.115, 0.072), 0.004),
    ],
)
def test_what_is_seen_is_as_large_as_what_is_touched(built, name, size, within):
    at = positions(load_gltf(built[f"{name}.glb"]))
    assert np.abs(at.max(axis=0) - at.min(axis=0) - size).max() < within


def test_the_apple_is_round_about_its_middle(built):
    body = positions(load_gltf(built["apple.glb"]))[: 37 * 57]
    level = np.abs(body[:, 1]) < 0.1 * APPLE_RADIUS
    assert np.hypot(body[level, 0], body[level, 2]) == pytest.approx(APPLE_RADIUS, rel=0.05)
    assert -body[:, 1].min() == pytest.approx(APPLE_RADIUS, rel=0.12)


def test_every_triangle_faces_its_normals(built):
    for name, file in built.items():
        for mesh in finest(load_gltf(file)):
            for part in mesh.primitives:
                corners = part.mesh.positions.astype(float)[part.mesh.indices.reshape(-1, 3)]
                faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                mean = part.mesh.normals[part.mesh.indices.reshape(-1, 3)].mean(axis=1)
                against = np.einsum("ij,ij->i", faces, mean) < -1e-12
                if name == "meadow.glb":  # blades of grass are lit from above on both sides
                    continue
                assert against.mean() < 0.01, f"{name} {mesh.name}: {against.mean():.1%} turned over"
