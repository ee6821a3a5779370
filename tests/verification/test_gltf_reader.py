"""The glTF reader against numbers written by the tests, and against trimesh on files of other people."""

from __future__ import annotations

import base64
import io
import math
import os
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from mimics_app.world.files.gltf.file import GltfError, load_gltf
from tests.support.gltf_maker import INDICES, POSITIONS, GltfMaker, glb, square, write_gltf
from tests.support.shared_data import shared_folder


def one_primitive(maker, **primitive):
    maker.more |= {"meshes": [{"primitives": [primitive]}], "nodes": [{"mesh": 0}]}
    return maker.document()


def mesh_of(folder, document):
    return load_gltf(write_gltf(folder / "m.gltf", document)).meshes[0].primitives[0].mesh


def test_a_square_is_read_from_a_data_uri_a_file_beside_it_and_a_glb(tmp_path):
    document = square()
    blob = base64.b64decode(document["buffers"][0]["uri"].partition(",")[2])
    (tmp_path / "a b.bin").write_bytes(blob)
    files = [write_gltf(tmp_path / "uri.gltf", document)]
    document["buffers"][0]["uri"] = "a%20b.bin"
    files.append(write_gltf(tmp_path / "beside.gltf", document))
    del document["buffers"][0]["uri"]
    (tmp_path / "own.glb").write_bytes(glb(document, blob))
    files.append(tmp_path / "own.glb")
    for file in files:
        found = load_gltf(file)
        mesh = found.meshes[0].primitives[0].mesh
        assert mesh.positions[mesh.indices].tolist() == POSITIONS[INDICES].tolist()
    assert load_gltf(files[1]).files == [tmp_path / "beside.gltf", tmp_path / "a b.bin"]


def test_missing_normals_are_flat_each_triangle_with_vertices_of_its_own(tmp_path):
    maker = GltfMaker()
    tent = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    corners = np.array([0, 1, 2, 0, 2, 3], np.uint8)
    mesh = mesh_of(
        tmp_path, one_primitive(maker, attributes={"POSITION": maker.array(tent)}, indices=maker.array(corners))
    )
    assert len(mesh.positions) == 6
    assert mesh.normals.tolist() == [[0, 0, 1]] * 3 + [[1, 0, 0]] * 3


def test_interleaved_attributes_are_read_with_their_stride(tmp_path):
    maker = GltfMaker()
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    view = maker.view(np.hstack([POSITIONS, normals]).tobytes(), byteStride=24)
    maker.accessors += [
        {"bufferView": view, "byteOffset": offset, "componentType": 5126, "count": 4, "type": "VEC3"}
        for offset in (0, 12)
    ]
    mesh = mesh_of(
        tmp_path, one_primitive(maker, attributes={"POSITION": 0, "NORMAL": 1}, indices=maker.array(INDICES))
    )
    assert mesh.positions.tolist() == POSITIONS.tolist()
    assert mesh.normals.tolist() == normals.tolist()


@pytest.mark.parametrize("base", [True, False])
def test_sparse_values_replace_those_of_the_base_or_of_zeros(tmp_path, base):
    maker = GltfMaker()
    position = maker.array(POSITIONS)
    if not base:
        del maker.accessors[0]["bufferView"]
    where = maker.view(np.array([1, 3], np.uint16).tobytes())
    what = maker.view(np.array([[5, 5, 5], [7, 7, 7]], np.float32).tobytes())
    maker.accessors[0]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": where, "componentType": 5123},
        "values": {"bufferView": what},
    }
    normal = maker.array(np.tile(np.float32([0, 0, 1]), (4, 1)))
    mesh = mesh_of(
        tmp_path,
        one_primitive(maker, attributes={"POSITION": position, "NORMAL": normal}, indices=maker.array(INDICES)),
    )
    expected = POSITIONS.copy() if base else np.zeros_like(POSITIONS)
    expected[[1, 3]] = [[5, 5, 5], [7, 7, 7]]
    assert mesh.positions.tolist() == expected.tolist()


@pytest.mark.parametrize(
    ("dtype", "values", "expected"),
    [
        ("u1", [0, 51, 255, 255], [0, 0.2, 1, 1]),
        ("u2", [0, 13107, 65535, 65535], [0, 0.2, 1, 1]),
        ("i1", [-128, -127, 0, 127], [-1, -1, 0, 1]),
        ("i2", [-32768, -32767, 0, 32767], [-1, -1, 0, 1]),
    ],
)
def test_normalised_integers_are_the_shares_the_specification_says(tmp_path, dtype, values, expected):
    maker = GltfMaker()
    colours = np.tile(np.array(values, dtype), (4, 1))
    attributes = {"POSITION": maker.array(POSITIONS), "COLOR_0": maker.array(colours, normalized=True)}
    attributes["NORMAL"] = maker.array(np.tile(np.float32([0, 0, 1]), (4, 1)))
    mesh = mesh_of(tmp_path, one_primitive(maker, attributes=attributes, indices=maker.array(INDICES)))
    assert mesh.colours[0] == pytest.approx(expected, abs=1e-7)


def test_colours_of_three_components_are_opaque(tmp_path):
    maker = GltfMaker()
    attributes = {"POSITION": maker.array(POSITIONS), "COLOR_0": maker.array(np.full((4, 3), 0.5, np.float32))}
    mesh = mesh_of(tmp_path, one_primitive(maker, attributes=attributes, indices=maker.array(INDICES)))
    assert mesh.colours[0].tolist() == [0.5, 0.5, 0.5, 1.0]


@pytest.mark.parametrize(
    ("mode", "corners"),
    [(4, [0, 1, 2, 2, 1, 3]), (5, [0, 1, 2, 1, 3, 2]), (6, [1, 2, 0, 2, 3, 0])],
)
def test_lists_strips_and_fans_face_the_way_the_specification_says(tmp_path, mode, corners):
    maker = GltfMaker()
    attributes = {"POSITION": maker.array(POSITIONS), "NORMAL": maker.array(np.tile(np.float32([0, 0, 1]), (4, 1)))}
    order = [0, 1, 2, 2, 1, 3] if mode == 4 else [0, 1, 2, 3]
    indices = maker.array(np.array(order, np.uint32))
    mesh = mesh_of(tmp_path, one_primitive(maker, attributes=attributes, indices=indices, mode=mode))
    assert mesh.indices.tolist() == corners


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_points_and_lines_are_left_out_with_a_note(tmp_path, mode):
    maker = GltfMaker()
    document = one_primitive(maker, attributes={"POSITION": maker.array(POSITIONS)}, mode=mode)
    found = load_gltf(write_gltf(tmp_path / "m.gltf", document))
    assert found.meshes[0].primitives == []
    assert found.notes == ["/meshes/0/primitives/0 left out: points and lines are not drawn"]


def test_normals_of_another_length_are_scaled_and_noted(tmp_path):
    maker = GltfMaker()
    attributes = {
        "POSITION": maker.array(POSITIONS),
        "NORMAL": maker.array(np.float32([[0, 0, 2], [0, 0, 0], [3, 0, 4], [0, 1, 0]])),
    }
    document = one_primitive(maker, attributes=attributes, indices=maker.array(INDICES))
    found = load_gltf(write_gltf(tmp_path / "m.gltf", document))
    assert found.meshes[0].primitives[0].mesh.normals == pytest.approx(
        np.array([[0, 0, 1], [0, 1, 0], [0.6, 0, 0.8], [0, 1, 0]])
    )
    assert "not of length 1" in found.notes[0]


def textured(maker, info, **material):
    buffer = io.BytesIO()
    Image.fromarray(np.array([[[255, 0, 0], [0, 255, 0]]], np.uint8)).save(buffer, "PNG")
    maker.more |= {
        "images": [{"bufferView": maker.view(buffer.getvalue()), "mimeType": "image/png"}],
        "samplers": [{"wrapS": 33071, "wrapT": 33648, "minFilter": 9728}],
        "textures": [{"source": 0, "sampler": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, **info}}, **material}],
    }


def test_a_texture_with_its_sampler_and_coordinates_moved_by_its_transform(tmp_path):
    maker = GltfMaker()
    shift = {"offset": [0.25, 0.5], "rotation": math.pi / 2, "scale": [2, 3], "texCoord": 1}
    textured(maker, {"extensions": {"KHR_texture_transform": shift}})
    attributes = {
        "POSITION": maker.array(POSITIONS),
        "NORMAL": maker.array(np.tile(np.float32([0, 0, 1]), (4, 1))),
        "TEXCOORD_0": maker.array(np.zeros((4, 2), np.float32)),
        "TEXCOORD_1": maker.array(np.float32([[0, 0], [1, 0], [0, 1], [1, 1]])),
    }
    document = one_primitive(maker, attributes=attributes, indices=maker.array(INDICES), material=0)
    found = load_gltf(write_gltf(tmp_path / "m.gltf", document))
    # The extension: first scaled, then turned by [[cos, sin], [-sin, cos]] of column vectors, then shifted.
    expected = [[0.25, 0.5], [0.25, -1.5], [3.25, 0.5], [3.25, -1.5]]
    assert found.meshes[0].primitives[0].mesh.uvs == pytest.approx(np.array(expected), abs=1e-6)
    texture = found.textures[found.materials[0].base_texture]
    assert texture.pixels.tolist() == [[[255, 0, 0, 255], [0, 255, 0, 255]]]
    assert (texture.wrap, texture.filter) == (("clamp", "mirror"), "nearest")


def test_material_values_defaults_and_unique_names(tmp_path):
    document = {"asset": {"version": "2.0"}}
    document["materials"] = [
        {},
        {
            "name": "Paint",
            "alphaMode": "MASK",
            "alphaCutoff": 0.3,
            "doubleSided": True,
            "emissiveFactor": [0, 0.5, 1],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}},
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
                "metallicFactor": 0,
                "roughnessFactor": 0.25,
            },
        },
        {"name": "Paint", "extensions": {"KHR_materials_unlit": {}}},
    ]
    plain, paint, unlit = load_gltf(write_gltf(tmp_path / "m.gltf", document)).materials
    assert (plain.base_colour, plain.metallic, plain.roughness, plain.alpha_mode) == ((1, 1, 1, 1), 1, 1, "opaque")
    assert (paint.base_colour, paint.metallic, paint.roughness) == ((0.1, 0.2, 0.3, 0.4), 0, 0.25)
    assert (paint.alpha_mode, paint.alpha_cutoff, paint.double_sided, paint.emission) == ("mask", 0.3, True, (0, 2, 4))
    assert (unlit.technique, unlit.name) == ("unlit", "Paint.001")


def test_all_maps_of_a_material_are_read_each_with_its_place(tmp_path):
    document = square()
    buffer = io.BytesIO()
    Image.new("RGB", (2, 2)).save(buffer, "PNG")
    picture = base64.b64encode(buffer.getvalue()).decode()
    document["images"] = [{"uri": f"data:image/png;base64,{picture}"}]
    document["textures"] = [{"source": 0}]
    shifted = {"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, 4]}}
    base_place = {"KHR_texture_transform": {"offset": [0.5, 0], "scale": [2, 2]}}
    document["materials"] = [
        {
            "pbrMetallicRoughness": {
                "baseColorTexture": {"index": 0, "extensions": base_place},
                "metallicRoughnessTexture": {"index": 0, "extensions": base_place},
            },
            "normalTexture": {"index": 0, "scale": 0.5, "extensions": shifted},
            "occlusionTexture": {"index": 0, "strength": 0.25, "texCoord": 1},
            "emissiveTexture": {"index": 0},
            "emissiveFactor": [1, 1, 1],
        }
    ]
    model = load_gltf(write_gltf(tmp_path / "m.gltf", document))
    material = model.materials[0]
    assert material.technique == "pbr"
    assert material.textures == {which: "texture0" for which in ("base", "normal", "surface", "occlusion", "emission")}
    assert material.second_uv == ("occlusion",) and material.uv_transforms[3] == (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    assert (material.normal_scale, material.occlusion_strength) == (0.5, 0.25)
    assert model.notes == []
    # The mesh's coordinates are 2 uv + (1/2, 0) already; from there to 2 u + 1/4, 4 v + 1/2, and back to u, v.
    assert material.uv_transforms[0] == material.uv_transforms[2] == (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    assert material.uv_transforms[1] == pytest.approx((1.0, 0.0, -0.25, 0.0, 2.0, 0.5), abs=1e-15)
    assert material.uv_transforms[4] == pytest.approx((0.5, 0.0, -0.25, 0.0, 0.5, 0.0), abs=1e-15)


def test_a_map_on_a_second_set_has_these_coordinates_without_the_transform_of_the_first(tmp_path):
    maker = GltfMaker()
    others = {"occlusionTexture": {"index": 0, "texCoord": 1}, "emissiveTexture": {"index": 0, "texCoord": 2}}
    textured(maker, {"extensions": {"KHR_texture_transform": {"scale": [2, 4]}}}, **others)
    corners = np.float32([[0, 0], [1, 0], [0, 1], [1, 1]])
    attributes = {"POSITION": maker.array(POSITIONS), "TEXCOORD_0": maker.array(corners)}
    attributes |= {"TEXCOORD_1": maker.array(corners[::-1].copy()), "TEXCOORD_2": maker.array(corners)}
    document = one_primitive(maker, attributes=attributes, indices=maker.array(INDICES), material=0)
    model = load_gltf(write_gltf(tmp_path / "m.gltf", document))
    mesh = model.meshes[0].primitives[0].mesh
    np.testing.assert_allclose(mesh.second_uvs, 1.0 - mesh.uvs / [2.0, 4.0], atol=1e-7)
    assert model.materials[0].second_uv == ("occlusion",)
    (note,) = model.notes
    assert "not used: emissiveTexture; their texture coordinates are a third set" in note


def test_a_node_matrix_is_taken_apart_column_by_column_also_mirrored(tmp_path):
    document = square()
    matrix = np.array([[0, -2, 0, 5], [-1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1.0]])  # determinant < 0
    document["nodes"][0]["matrix"] = matrix.T.ravel().tolist()
    node = load_gltf(write_gltf(tmp_path / "m.gltf", document)).nodes[0]
    from mimics_app.maths.mat import compose

    assert compose(node.translation, node.rotation, node.scale) == pytest.approx(matrix, abs=1e-14)


def test_a_chain_of_two_hundred_nodes_is_read_and_walked(tmp_path):
    document = {"asset": {"version": "2.0"}, "nodes": [{"children": [i + 1]} for i in range(199)] + [{}]}
    found = load_gltf(write_gltf(tmp_path / "m.gltf", document))
    assert list(found.subtree(0)) == list(range(200))
    assert found.roots == [0]


EXPECTED = {
    "IncorrectVertexArrays/Cube.gltf": ["#/meshes/1/primitives/0: 35 indices are not a multiple of three"],
    "SchemaFailures/sceneWrongType.gltf": [
        "#/scene: 'hello' is not an index into scenes",
        '#/buffers/0/uri: no file "BoxTextured0.bin"',
    ],
    "boom_box.gltf": [
        '#/buffers/0/uri: no file "boom_box0.bin"',
        '#/images/0/uri: no file "textures/boom_box_base_color.png"',
    ],
}
"""What the malformed files of the shared data are refused with; every other one is read."""

COUNTS = {
    "24_animation_pointer/24_animation_pointer.gltf": {"nodes": 64, "cameras": 4, "lights": 4},
    "Cameras/Cameras.gltf": {"cameras": 2},
    "alien.glb": {"nodes": 8, "meshes": 6, "materials": 5},
    "BoxTextured.glb": {"textures": 1},
    "quad_skin.glb": {"nodes": 23},
    "TestNoRootNode/NoScene.gltf": {"nodes": 0},
}


def test_every_file_of_the_shared_data_is_read_or_refused_with_its_place():
    folder = shared_folder("gltf")
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".gltf", ".glb"))
    assert len(files) >= 30
    for path in files:
        name = path.relative_to(folder).as_posix()
        if name in EXPECTED:
            with pytest.raises(GltfError) as caught:
                load_gltf(path)
            lines = [str(issue) for issue in caught.value.issues]
            for place in EXPECTED[name]:
                assert any(place in line for line in lines), (name, lines)
        else:
            found = load_gltf(path)
            assert all(len(getattr(found, key)) == count for key, count in COUNTS.get(name, {}).items()), name


def test_geometry_of_the_shared_files_is_what_trimesh_reads():
    """Corner by corner, in file order; normals that the file has are compared too."""
    folder = shared_folder("gltf")
    compared = 0
    for path in sorted(folder.rglob("*.gl*")):
        name = path.relative_to(folder).as_posix()
        if path.suffix not in (".gltf", ".glb") or name in EXPECTED:
            continue
        ours = load_gltf(path)
        if not any(mesh.primitives for mesh in ours.meshes):
            continue
        theirs = list(trimesh.load_scene(path, process=False).geometry.values())
        for mesh in ours.meshes:
            for primitive in mesh.primitives:
                corners = primitive.mesh.positions[primitive.mesh.indices].reshape(-1, 3, 3)
                same = [
                    other
                    for other in theirs
                    if isinstance(other, trimesh.Trimesh)
                    and len(other.faces) == len(corners)
                    and np.abs(other.vertices[other.faces] - corners).max() <= 1e-6 * max(1.0, np.abs(corners).max())
                ]
                assert same, (name, mesh.name)
                compared += 1
    assert compared >= 60


def test_embedded_jpeg_and_sixteen_bit_grey_pictures_are_decoded(tmp_path):
    maker = GltfMaker()
    textured(maker, {})
    buffer = io.BytesIO()
    Image.new("L", (4, 3), 200).save(buffer, "JPEG")
    maker.more["images"] = [{"bufferView": maker.view(buffer.getvalue())}]
    found = load_gltf(write_gltf(tmp_path / "jpeg.gltf", maker.document()))
    assert found.textures["texture0"].pixels.shape == (3, 4, 4)
    assert abs(int(found.textures["texture0"].pixels[0, 0, 0]) - 200) <= 2
    Image.fromarray(np.full((2, 2), 0x8000, np.uint16)).save(tmp_path / "grey.png")
    maker.more["images"] = [{"uri": "grey.png"}]
    found = load_gltf(write_gltf(tmp_path / "grey.gltf", maker.document()))
    assert found.textures["texture0"].pixels[0, 0].tolist() == [128, 128, 128, 255]


def test_reading_leaves_no_file_open(tmp_path):
    path = write_gltf(tmp_path / "m.gltf", square())
    document = load_gltf(path)
    folder = Path("/proc/self/fd")
    if not folder.is_dir():
        pytest.skip("this system does not list open files")
    opened = [os.readlink(entry) for entry in folder.iterdir() if os.path.lexists(entry)]
    assert document is not None and not [name for name in opened if name.startswith(str(tmp_path))]


def test_the_glb_maker_makes_what_the_format_says():
    data = glb({"asset": {"version": "2.0"}}, b"xyz")
    assert struct.unpack_from("<4sII", data) == (b"glTF", 2, len(data))
