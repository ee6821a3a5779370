"""Sounds of a glTF model (KHR_audio_emitter): read into the scene's own sounds and emitters, or refused by pointer."""

from __future__ import annotations

import base64
import io
import json
import math

import numpy as np
import pytest
import soundfile

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.scene_sounds import settings_from_components
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.scene.file import build_world
from tests.support.gltf_maker import GltfMaker, write_gltf

RATE = 48_000
TONE = 0.5 * np.sin(np.arange(4800) * 0.1)
EXTENSION = "KHR_audio_emitter"


def encoded(kind: str) -> bytes:
    """The tone as a file of a kind."""
    file = io.BytesIO()
    soundfile.write(file, TONE, RATE, format=kind)
    return file.getvalue()


def document() -> dict:
    """A bell on a node with a cone and two sounds, one on a node without a name, and music everywhere."""
    maker = GltfMaker()
    view = maker.view(encoded("FLAC"))
    inline = "data:audio/wav;base64," + base64.b64encode(encoded("WAV")).decode()
    cone = {"shapeType": "cone", "coneInnerAngle": 0.5, "coneOuterAngle": 2.0, "coneOuterGain": 0.25}
    far = {"distanceModel": "linear", "refDistance": 2.0, "maxDistance": 20.0, "rolloffFactor": 0.5}
    maker.more = {
        "extensionsUsed": [EXTENSION],
        "scenes": [{"nodes": [0, 1], "extensions": {EXTENSION: {"emitters": [1]}}}],
        "nodes": [
            {"name": "Tower", "translation": [1.0, 2.0, 3.0], "children": [2]},
            {"translation": [0.0, 0.0, -4.0], "extensions": {EXTENSION: {"emitter": 2}}},
            {"name": "Bell", "translation": [0.0, 5.0, 0.0], "extensions": {EXTENSION: {"emitter": 0}}},
        ],
        "extensions": {
            EXTENSION: {
                "audio": [{"bufferView": view, "mimeType": "audio/flac"}, {"uri": inline}, {"uri": "music.ogg"}],
                "sources": [
                    {"audio": 0, "gain": 0.5, "loop": True, "autoPlay": True},
                    {"audio": 1},
                    {"audio": 2, "autoPlay": True},
                ],
                "emitters": [
                    {"type": "positional", "gain": 0.8, "sources": [0, 1], "positional": cone | far},
                    {"type": "global", "sources": [2]},
                    {"type": "positional", "sources": [0]},
                ],
            }
        },
    }
    return maker.document()


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "music.ogg").write_bytes(encoded("OGG"))
    write_gltf(tmp_path / "m.gltf", document())
    entities = [{"id": "eye", "components": {"camera": {}}}, {"id": "place", "components": {"mesh": {"source": "m"}}}]
    plain = {"format": "mimics-scene", "version": 1, "name": "bells", "scenario": "none", "entities": entities}
    (tmp_path / "scene.json").write_text(json.dumps(plain | {"assets": {"m": {"uri": "m.gltf"}}}))
    return load_checked_scene(tmp_path / "scene.json")


def test_emitters_of_a_model_become_sounds_and_emitters_of_the_scene(scene):
    sounds, emitters = scene.components(Sound), scene.components(SoundEmitter)
    names = ["place/Bell/sound_2", "place/Bell/sound_2_1", "place/sound_1", "place/everywhere_1"]
    assert sorted(name for name, _, _ in sounds) == sorted(name for name, _, _ in emitters) == sorted(names)
    bell = {name: emitter for name, emitter, _ in emitters}[names[0]]
    assert (bell.gain, bell.loop, bell.autoplay, bell.sound) == (0.8, True, True, names[0])
    assert (bell.distance_model, bell.reference_distance, bell.max_distance, bell.rolloff) == ("linear", 2, 20, 0.5)
    assert (bell.cone_inner, bell.cone_outer, bell.cone_gain) == (0.5, 2.0, 0.25)
    other = {name: emitter for name, emitter, _ in emitters}[names[2]]
    assert (other.cone_outer, other.distance_model, other.max_distance) == (6.2832, "inverse", 1e6)
    world = build_world(scene)
    world.update()
    assert world.find(names[0]).world_matrix()[:3, 3].tolist() == [1.0, 7.0, 3.0]
    assert world.find(names[2]).world_matrix()[:3, 3].tolist() == [0.0, 0.0, -4.0]
    world.find("place/Bell").set_position((0.0, 9.0, 0.0))
    world.update()
    assert world.find(names[0]).world_matrix()[:3, 3].tolist() == [1.0, 11.0, 3.0], "it moves with its node"


def test_what_is_heard_of_a_model_is_its_data(scene):
    settings = settings_from_components(
        scene.components(Sound), scene.components(SoundEmitter), scene.assets, scene.file, sink="null"
    )
    assert settings is not None
    assert sorted(settings.emitters) == ["place/Bell/sound_2", "place/everywhere_1", "place/sound_1"]
    assert settings.sounds["place/Bell/sound_2"].gain == pytest.approx(0.5 * 0.8)
    assert not settings.sounds["place/everywhere_1"].spatial and settings.sounds["place/sound_1"].spatial
    bank = SoundBank(settings.sounds, RATE)
    for name, error in (("place/Bell/sound_2", 1e-3), ("place/Bell/sound_2_1", 1e-3), ("place/everywhere_1", 0.06)):
        assert np.abs(bank[name].samples[1000:-1000] - TONE[1000:-1000]).max() < error, name


def at(*steps):
    return "/extensions/" + "/".join((EXTENSION, *map(str, steps)))


@pytest.mark.parametrize(
    ("place", "key", "value", "pointer"),
    [
        (("audio", 0), "bufferView", 7, at("audio", 0, "bufferView")),
        (("audio", 0), "mimeType", "video/mp4", at("audio", 0, "mimeType")),
        (("audio", 1), "uri", "data:audio/wav;base64,AAAA", at("audio", 1)),
        (("audio", 1), "uri", "../../etc/passwd", at("audio", 1, "uri")),
        (("audio", 1), "uri", "missing.wav", at("audio", 1, "uri")),
        (("sources", 1), "audio", 3, at("sources", 1, "audio")),
        (("sources", 1), "audio", None, at("sources", 1, "audio")),
        (("sources", 1), "loop", "yes", at("sources", 1, "loop")),
        (("sources", 1), "gain", -1.0, at("sources", 1, "gain")),
        (("sources",), 1, 5, at("sources", 1)),
        (("emitters", 0), "type", "loud", at("emitters", 0, "type")),
        (("emitters", 0), "sources", [0, 9], at("emitters", 0, "sources", 1)),
        (("emitters", 1), "positional", {}, at("emitters", 1, "positional")),
        (("emitters", 0, "positional"), "shapeType", "star", at("emitters", 0, "positional", "shapeType")),
        (("emitters", 0, "positional"), "refDistance", 0.0, at("emitters", 0, "positional", "refDistance")),
        (("emitters", 0, "positional"), "maxDistance", 1.0, at("emitters", 0, "positional", "maxDistance")),
        (("emitters", 0, "positional"), "distanceModel", "cubic", at("emitters", 0, "positional", "distanceModel")),
        (("emitters", 0, "positional"), "coneInnerAngle", math.pi, at("emitters", 0, "positional", "coneInnerAngle")),
        (("emitters", 0, "positional"), "coneOuterGain", 2.0, at("emitters", 0, "positional", "coneOuterGain")),
    ],
)
def test_what_is_wrong_is_refused_by_its_pointer(tmp_path, place, key, value, pointer):
    (tmp_path / "music.ogg").write_bytes(encoded("OGG"))
    spoiled = document()
    holder = spoiled["extensions"][EXTENSION]
    for step in place:
        holder = holder[step]
    holder[key] = value
    with pytest.raises(SceneError) as caught:
        load_gltf(write_gltf(tmp_path / "m.gltf", spoiled))
    assert pointer in {issue.pointer for issue in caught.value.issues}


@pytest.mark.parametrize(
    ("holder", "value", "pointer"),
    [
        ("nodes", {"emitter": 3}, f"/nodes/0/extensions/{EXTENSION}/emitter"),
        ("scenes", {"emitters": [1, 4]}, f"/scenes/0/extensions/{EXTENSION}/emitters/1"),
        ("scenes", {"emitters": [0]}, f"/scenes/0/extensions/{EXTENSION}/emitters/0"),
    ],
)
def test_a_node_and_a_scene_may_only_name_emitters_there_are(tmp_path, holder, value, pointer):
    (tmp_path / "music.ogg").write_bytes(encoded("OGG"))
    spoiled = document()
    spoiled[holder][0]["extensions"] = {EXTENSION: value}
    with pytest.raises(SceneError) as caught:
        load_gltf(write_gltf(tmp_path / "m.gltf", spoiled))
    assert pointer in {issue.pointer for issue in caught.value.issues}


def test_a_scene_may_name_ogg_and_flac_and_nothing_that_only_is_called_so(tmp_path):
    entities = [{"id": "music", "components": {"sound": {"asset": "s"}}}]
    plain = {"format": "mimics-scene", "version": 1, "name": "s", "scenario": "none", "entities": entities}
    for name, data, right in (
        ("a.ogg", encoded("OGG"), True),
        ("a.flac", encoded("FLAC"), True),
        ("b.ogg", b"x", False),
    ):
        (tmp_path / name).write_bytes(data)
        (tmp_path / "scene.json").write_text(json.dumps(plain | {"assets": {"s": {"uri": name}}}))
        if right:
            assert load_checked_scene(tmp_path / "scene.json").assets["s"].kind == "sound"
        else:
            with pytest.raises(SceneError, match="is not in OGG format"):
                load_checked_scene(tmp_path / "scene.json")
