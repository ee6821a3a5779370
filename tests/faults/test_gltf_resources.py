"""What a model may cost: memory is counted before it is taken, the work grows with the file, limits are stated."""

from __future__ import annotations

import json
import sys
import tracemalloc

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.gltf import clips, gltf_document, meshes
from mimics_app.world.files.gltf.clips import MAX_CHANNELS
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.gltf.gltf_document import MAX_ITEMS, MAX_NOTES, MAX_TOTAL_BYTES
from mimics_app.world.files.gltf.skins import MAX_SKINNED
from tests.support.gltf_maker import INDICES, POSITIONS, GltfMaker, square

ROOM = 8 * 1024 * 1024
"""Memory beside what is counted: the document, and blocks that are worked on [bytes]."""

ZEROS = {"componentType": 5121, "count": 48_000_000, "type": "SCALAR"}
NORMALS = np.tile(np.array([0, 0, 1], np.float32), (4, 1))


def save(folder, document):
    path = folder / "model.gltf"
    path.write_text(json.dumps(document))
    return path


def used_by_many(primitive, *accessors, primitives=40):
    """A small file in which many primitives use the same large accessors, which have no data; own ones come first."""
    maker = GltfMaker()
    maker.array(POSITIONS), maker.array(NORMALS), maker.array(INDICES)
    maker.accessors += accessors
    maker.more = {"meshes": [{"primitives": [primitive] * primitives}], "nodes": [{"mesh": 0}]}
    return maker.document()


LARGE = {
    "indices": used_by_many({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 3}, ZEROS),
    "indices_without_normals": used_by_many(
        {"attributes": {"POSITION": 0}, "indices": 3}, {**ZEROS, "count": 3_000_000}
    ),
    "strip": used_by_many(
        {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 3, "mode": 5}, {**ZEROS, "count": 3_000_000}
    ),
    "normalised_colours": used_by_many(
        {"attributes": {"POSITION": 3, "NORMAL": 3, "COLOR_0": 4}},
        {"componentType": 5126, "count": 3_000_000, "type": "VEC3"},
        {"componentType": 5121, "count": 3_000_000, "type": "VEC3", "normalized": True},
    ),
    "vertices": used_by_many(
        {"attributes": {"POSITION": 3, "NORMAL": 3}}, {"componentType": 5126, "count": 900_000, "type": "VEC3"}
    ),
}


@pytest.mark.parametrize("name", LARGE)
def test_small_file_that_would_take_gigabytes_is_refused_within_the_budget(tmp_path, name):
    path = save(tmp_path, LARGE[name])
    tracemalloc.start()
    try:
        with pytest.raises(SceneError, match="needs more than 256 MiB") as caught:
            load_gltf(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert sum("256 MiB" in issue.what for issue in caught.value.issues) == 1, "one fault of the whole file"
    assert peak < MAX_TOTAL_BYTES + ROOM, f"{peak / 2**20:.0f} MiB"


def own_meshes(count):
    """Meshes with an accessor and a buffer view of their own, a node and a material each, all of one name."""
    document = square()
    document["accessors"] += [dict(document["accessors"][0], bufferView=2 + i) for i in range(count)]
    document["bufferViews"] += [dict(document["bufferViews"][0]) for _ in range(count)]
    part = {"attributes": {"POSITION": 0}, "indices": 1}
    parts = [{**part, "attributes": {"POSITION": 2 + i}, "material": i} for i in range(count)]
    document["meshes"] = [{"name": "m", "primitives": [each]} for each in parts]
    document["materials"] = [{"name": "same"} for _ in range(count)]
    document["nodes"] = [{"name": "n", "mesh": i} for i in range(count)]
    document["scenes"] = [{"nodes": list(range(count))}]
    return document


def one_mesh(count):
    """Primitives of one mesh, every second one a line, which is noted."""
    document = square()
    primitive = document["meshes"][0]["primitives"][0]
    document["meshes"][0]["primitives"] = [{**primitive, "mode": 4 if i % 2 else 1} for i in range(count)]
    return document


def deep_nodes(count):
    document = square()
    document["nodes"] = [{"children": list(range(1, count))}] + [{"mesh": 0} for _ in range(count - 1)]
    return document


def many_faults(count):
    document = square()
    document["nodes"] = [{"mesh": 5, "name": i} for i in range(count)]
    document["scenes"] = [{"nodes": list(range(count))}]
    return document


def calls_of(path):
    """How many calls of Python and built-in functions reading a file takes."""
    calls = 0

    def count(frame, event, argument):
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        load_gltf(path)
    except SceneError:
        pass
    finally:
        sys.setprofile(None)
    return calls


@pytest.mark.parametrize("make", [own_meshes, one_mesh, deep_nodes, many_faults], ids=lambda make: make.__name__)
def test_work_grows_with_the_file_and_not_with_its_square(tmp_path, make):
    load_gltf(save(tmp_path, square()))
    few, many = (calls_of(save(tmp_path, make(count))) for count in (100, 800))
    assert many < 9 * few, f"{few} and {many} calls: {np.log(many / few) / np.log(8):.2f} is the power"


def test_as_many_top_nodes_as_there_may_be_are_read(tmp_path):
    """A search through the list for each of them would take minutes."""
    document = square()
    document["nodes"] = [{} for _ in range(MAX_ITEMS)]
    document["scenes"] = [{"nodes": list(range(MAX_ITEMS))}]
    assert len(load_gltf(save(tmp_path, document)).roots) == MAX_ITEMS


def test_one_top_node_more_is_refused(tmp_path):
    document = square()
    document["nodes"] = [{} for _ in range(MAX_ITEMS + 1)]
    with pytest.raises(SceneError, match="/nodes: 100001 nodes are more than 100000"):
        load_gltf(save(tmp_path, document))


FEW = 100


@pytest.fixture
def few(monkeypatch):
    """The same limits a thousandth as high: what a list of 400,000 costs is json's."""
    assert MAX_ITEMS == 1000 * FEW
    for module in (gltf_document, meshes):
        monkeypatch.setattr(module, "MAX_ITEMS", FEW)
    monkeypatch.setattr(
        gltf_document, "_OTHER_ITEMS", {name: most // 1000 for name, most in gltf_document._OTHER_ITEMS.items()}
    )


@pytest.mark.parametrize("name", ["nodes", "meshes", "materials", "textures", "cameras"])
def test_lists_have_stated_limits(few, tmp_path, name):
    document = square()
    document[name] = [{} for _ in range(FEW + 1)]
    with pytest.raises(SceneError, match=f"/{name}: 101 {name} are more than 100"):
        load_gltf(save(tmp_path, document))


@pytest.mark.parametrize("name", ["accessors", "bufferViews"])
def test_what_meshes_have_several_of_may_be_more(few, tmp_path, name):
    document = square()
    document[name] = [{} for _ in range(4 * FEW + 1)]
    with pytest.raises(SceneError, match=f"401 {name} are more than 400"):
        load_gltf(save(tmp_path, document))


def moving(animations: int, channels: int, nodes: int = 1, **more):
    """Animations that move nodes; a channel is two numbers in the file."""
    maker = GltfMaker()
    times, places = maker.array(np.array([0, 1], np.float32)), maker.array(POSITIONS[:2])
    target = {"sampler": 0, "target": {"node": 0, "path": "translation"}}
    clip = {"channels": [target] * channels, "samplers": [{"input": times, "output": places}]}
    maker.more = {"nodes": [{}] * nodes, "scenes": [{"nodes": [*range(nodes)]}], "animations": [clip] * animations}
    return maker.document() | more


@pytest.mark.parametrize(("animations", "channels"), [(1, MAX_CHANNELS + 1), (100, MAX_CHANNELS // 100 + 1)])
def test_channels_of_all_animations_together_have_a_limit(tmp_path, animations, channels, monkeypatch):
    monkeypatch.setattr(clips.GltfClips, "_read", lambda *_: pytest.fail("read before the limit is asked"))
    with pytest.raises(SceneError, match="more than 40000 channels"):
        load_gltf(save(tmp_path, moving(animations, channels)))


def test_animations_have_a_limit_of_their_own(tmp_path):
    assert len(load_gltf(save(tmp_path, moving(50, 1))).clips) == 50
    with pytest.raises(SceneError, match="10001 animations are more than 10000"):
        load_gltf(save(tmp_path, moving(10_001, 1)))


def test_nodes_with_a_skin_have_a_limit(tmp_path):
    document = square()
    document["skins"] = [{"joints": [0]}]
    document["nodes"] = [{}, *({"mesh": 0, "skin": 0} for _ in range(MAX_SKINNED + 1))]
    document["scenes"] = [{"nodes": [*range(MAX_SKINNED + 2)]}]
    with pytest.raises(SceneError, match="more than 5000 nodes have a skin"):
        load_gltf(save(tmp_path, document))


def test_primitives_of_all_meshes_together_have_a_limit(few, tmp_path):
    document = square()
    document["meshes"] = [{"primitives": [{"mode": 1, "attributes": {}}] * (FEW // 2 + 1)} for _ in range(2)]
    with pytest.raises(SceneError, match="/meshes/1/primitives: the model has more than 100 primitives"):
        load_gltf(save(tmp_path, document))


def test_of_very_many_notes_the_number_is_reported(tmp_path):
    notes = load_gltf(save(tmp_path, one_mesh(1000))).notes
    assert len(notes) == MAX_NOTES + 1
    assert notes[-1] == f"and {500 - MAX_NOTES} more notes"
