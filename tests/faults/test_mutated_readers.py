"""Every reader of a file that people write is given spoiled files: it takes them or refuses them, and nothing else.

10^4 of them in `make test`, 10^6 in `make test-long`; those of recordings are spoiled in a module of their own.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from PIL import Image

from mimics_app.app.commands.check import examine
from mimics_app.app.sweep.experiments import NAMES, find_experiment
from mimics_app.contracts.errors import Issue, SceneError, UsageError
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.system.resources import root
from mimics_app.lab.sweep.points import count_points
from mimics_app.lab.sweep.spec import load_sweep, span_of
from mimics_app.learning.action_sequence import load_action_sequence
from mimics_app.rendering.haptic.tunnel_source import read_path
from mimics_app.tasks.trial_file import load_blocks
from mimics_app.world.content.world import World
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.scene.model_world import read_model
from tests.support import hostile_readers
from tests.support.gltf_maker import INDICES, POSITIONS, GltfMaker, glb
from tests.support.mutations import as_text, spoil_bytes, spoil_json, survey

SCENES = ("parts/touch_table", "examples/lanterns", "examples/wired", "examples/two_fingers", "examples/mirrors")
SCENES += ("examples/springs_and_magnets", "examples/surfaces", "examples/force_field", "examples/guided_path")
SCENES += ("examples/billboards_and_particles", "examples/decals", "examples/free_objects", "wavy_tunnel")

ACTIONS = [{"trial": i, "x-why": ["any"], "values": {"radius": 1.2}} for i in range(4)]
ACTIONS += [{"t": 12.5, "x-why": {"a": "any"}, "values": {"stiffness": 800, "radius": 0.5}} for _ in range(4)]
SPACE = ActionSpace([Parameter("radius", 1.0, 0.5, 2.0), Parameter("stiffness", 500.0, 0.0, 1000.0, unit="N/m")])

SWEEP = {
    "format": "mimics-sweep",
    "version": 1,
    "experiment": "wall_stability",
    "parameters": {
        "stiffness": {"from": 100.0, "to": 1e5, "scale": "log", "count": 3},
        "period": [0.001, 0.002],
        "delay_ticks": {"from": 0, "to": 5},
        "mass": 1.5,
    },
    "sample": {"points": 10, "seed": 1},
    "chunk": 10,
}


def model() -> tuple[dict[str, Any], bytes]:
    """A model with something of everything the reader knows, and its binary chunk."""
    maker = GltfMaker()
    position, indices = maker.array(POSITIONS), maker.array(INDICES)
    normal = maker.array(np.tile(np.array([0, 0, 1], np.float32), (4, 1)))
    uv = maker.array(np.array([[0, 0], [255, 0], [0, 255], [255, 255]], np.uint8), normalized=True)
    shade = maker.array(np.full((4, 4), 200, np.uint8), normalized=True)
    drawn = io.BytesIO()
    Image.new("RGB", (2, 2), "red").save(drawn, "PNG")
    picture = maker.view(drawn.getvalue())
    zeros = {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2}}
    zeros["sparse"] |= {"indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}
    maker.accessors.append(zeros)
    attributes = {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv, "COLOR_0": shade}
    textured = {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}}
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": [0, 3]}],
        "nodes": [
            {"name": "A", "mesh": 0, "children": [1, 2], "rotation": [0, 0, 0.7071, 0.7071], "scale": [1, 2, 1]},
            {"name": "B", "mesh": 1, "matrix": np.eye(4).ravel().tolist(), "extras": {"mimics": {"components": {}}}},
            {"camera": 0, "translation": [0, 1, 2], "extensions": {"KHR_node_visibility": {"visible": False}}},
            {"extensions": {"KHR_lights_punctual": {"light": 0}, "MSFT_lod": {"ids": [4]}}, "mesh": 0},
            {"mesh": 1},
        ],
        "meshes": [
            {"name": "M", "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]},
            {"primitives": [{"attributes": {"POSITION": position}, "mode": 5}, {"attributes": {"POSITION": 5}}]},
        ],
        "materials": [
            {"name": "m", "pbrMetallicRoughness": {"roughnessFactor": 0.5, **textured}, "alphaMode": "MASK"},
            {"emissiveFactor": [1, 0, 0], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}},
        ],
        "textures": [{"source": 0, "sampler": 0}],
        "images": [{"bufferView": picture, "mimeType": "image/png"}],
        "samplers": [{"wrapS": 33071, "minFilter": 9729}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "zfar": 50}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {"outerConeAngle": 0.5}}]}},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
    }
    maker.more["meshes"][1]["primitives"].pop()
    document = maker.document()
    document["buffers"] = [{"byteLength": len(maker.blob)}]
    document["meshes"][0]["primitives"].append({"attributes": {"POSITION": len(maker.accessors) - 1}})
    document["meshes"][0]["primitives"][-1]["indices"] = indices
    return document, maker.blob


def read_model_of(path: Path) -> None:
    """As `mimics view` reads it: into a world too."""
    world = World()
    read_model(path).instantiate(world, world.root)
    world.update()


def gltf_json(folder: Path) -> Callable[[int], object]:
    document, binary = model()
    path = folder / "model.glb"

    def read(seed: int) -> None:
        path.write_bytes(glb(spoil_json(document, seed), binary))
        load_gltf(path) if seed % 4 else read_model_of(path)

    return read


def gltf_bytes(folder: Path) -> Callable[[int], object]:
    original = glb(*model())
    path = folder / "model.glb"

    def read(seed: int) -> None:
        path.write_bytes(spoil_bytes(original, seed))
        load_gltf(path)

    return read


def scenes(folder: Path) -> Callable[[int], object]:
    known = [json.loads((root() / "scenes" / f"{name}.json").read_text()) for name in SCENES]
    for document in known:
        document["include"] = [f"mimics:scenes/parts/{Path(uri).name}" for uri in document.get("include", [])]
    path = folder / "scene.json"

    def read(seed: int) -> None:
        document = known[seed % len(known)]
        text = as_text(spoil_json(document, seed))
        path.write_bytes(text if seed % 5 else spoil_bytes(as_text(document), seed))
        examine(path)

    return read


def actions(folder: Path) -> Callable[[int], object]:
    path = folder / "actions.json"

    def read(seed: int) -> None:
        path.write_bytes(as_text(spoil_json(ACTIONS, seed)) if seed % 3 else spoil_bytes(as_text(ACTIONS), seed))
        load_action_sequence(path, SPACE)

    return read


def sweeps(folder: Path) -> Callable[[int], object]:
    path = folder / "sweep.json"

    def read(seed: int) -> None:
        path.write_bytes(as_text(spoil_json(SWEEP, seed)) if seed % 3 else spoil_bytes(as_text(SWEEP), seed))
        sweep = load_sweep(path, find_experiment, NAMES)
        count_points(sweep), span_of(sweep), sweep.digest

    return read


def paths(folder: Path) -> Callable[[int], object]:
    points = [[0.1 * i, 0.0, 0.05 * (i % 3)] for i in range(8)]
    lines = "x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in points)

    def read(seed: int) -> None:
        path = folder / ("path.csv" if seed % 2 else "path.json")
        path.write_bytes(spoil_bytes(lines.encode(), seed) if seed % 2 else as_text(spoil_json(points, seed)))
        read_path(path)

    return read


def trials(folder: Path) -> Callable[[int], object]:
    blocks = [{"name": "A", "trials": [{"label": "easy", "values": {"radius": 1.2}, "rest_s": 2.0}], "repetitions": 2}]
    path = folder / "trials.json"

    def read(seed: int) -> None:
        path.write_bytes(as_text(spoil_json(blocks, seed)) if seed % 3 else spoil_bytes(as_text(blocks), seed))
        load_blocks(path)

    return read


READERS = {
    "glTF, JSON": (gltf_json, 1500, 120_000),
    "glTF, bytes": (gltf_bytes, 1200, 270_000),
    "scenes": (scenes, 800, 24_000),
    "actions": (actions, 1000, 110_000),
    "sweeps": (sweeps, 1000, 80_000),
    "paths": (paths, 700, 100_000),
    "trials": (trials, 800, 120_000),
}
"""What reads, how often in `make test`, and how often in `make test-long`: 10^4 and 10^6 in all, 20 minutes of a
processor."""


FILES = ("BVH", "C3D", "SOFA", "sound", "recording", "study", "commands", "walls", "headset", "tracker tape")
FILES += ("body signals", "EDF", "measures of a person", "fit", "costs of methods", "settings", "machine memory")
OTHERS = {name: hostile_readers.READERS[name] for name in FILES} | hostile_readers.WIRES
"""Further readers, and the wires, whose bytes are spoiled."""
FEW_OF = dict.fromkeys(FILES, 120) | dict.fromkeys(hostile_readers.WIRES, 80)
MANY_OF = dict.fromkeys(FILES, 8_000) | dict.fromkeys(hostile_readers.WIRES, 3_400) | {"OSC": 2_600}


def other(name: str, folder: Path) -> Callable[[int], object]:
    """Read spoiled bytes; a refusal of a wire, and of the settings, names no file."""
    reader = OTHERS[name]
    path = folder / "inside" / (reader.suffix if "." in reader.suffix[1:] else f"file{reader.suffix}")
    path.parent.mkdir(parents=True)

    def read(seed: int) -> None:
        spoiled = spoil_bytes(reader.original, seed)
        if name in FILES:
            path.write_bytes(spoiled)
        try:
            reader.read(path if name in FILES else spoiled)
        except (ValueError, UsageError, msgspec.DecodeError) as refused:
            if name in FILES and name != "settings":
                raise
            raise SceneError(Issue(name, "", ascii(refused)[:200])) from refused

    return read


def test_counts_are_those_that_are_promised():
    assert sum(few for _, few, _ in READERS.values()) + sum(FEW_OF.values()) == 10**4
    assert sum(many for _, _, many in READERS.values()) + sum(MANY_OF.values()) == 10**6


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.fault(id="F13")
def test_spoiled_bytes_are_read_or_refused_by_every_reader_and_wire(tmp_path, name, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    found = survey(other(name, tmp_path), range(FEW_OF[name]))
    assert not found.findings, found


@pytest.mark.slow
@pytest.mark.parametrize("name", OTHERS)
def test_many_spoiled_bytes_are_read_or_refused_by_every_reader_and_wire(tmp_path, name, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    found = survey(other(name, tmp_path), range(FEW_OF[name], FEW_OF[name] + MANY_OF[name]))
    assert not found.findings, found


@pytest.mark.parametrize("name", READERS)
@pytest.mark.fault(id="F13")
def test_spoiled_files_are_read_or_refused(tmp_path, name):
    reader, few, _ = READERS[name]
    check(reader(tmp_path), range(few))


@pytest.mark.slow
@pytest.mark.parametrize("name", READERS)
def test_a_million_spoiled_files_are_read_or_refused(tmp_path, name):
    reader, few, many = READERS[name]
    check(reader(tmp_path), range(few, few + many))


def check(read, seeds):
    found = survey(read, seeds)
    assert not found.findings, found
    assert found.read > 0.01 * len(seeds), found  # else the faults hide each other
    assert found.refused > 0.2 * len(seeds), found
