"""Sounds of a glTF file (KHR_audio_emitter, draft of 2024): data, sources and emitters, validated.

Emitters become the scene's own components `sound` and `sound_emitter`. Of the draft's formats WAV
and MP3 are read, and OGG and FLAC beside them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from mimics_app.world.files.gltf.buffers import GltfBuffers, data_uri
from mimics_app.world.files.gltf.gltf_document import GltfSource, open_gltf

__all__ = ["EXTENSION", "GltfAudio", "GltfEmitter", "GltfSounds", "read_embedded_sound", "read_sounds"]

EXTENSION = "KHR_audio_emitter"

_PLACE = f"/extensions/{EXTENSION}"
_TYPES = ("audio/wav", "audio/mpeg", "audio/ogg", "audio/flac")
_MODELS = ("inverse", "linear", "exponential")
_MAX_GAIN = 4.0
"""Maximum gain of the scene's components."""

_MAX_DISTANCE = 1e6
"""Distance that stands for no maximum distance [m]: the limit of the component."""

_WHOLE = 6.2832
"""Full angle of an omnidirectional cone [rad]."""


@dataclass(frozen=True, slots=True)
class GltfAudio:
    """Data of a sound: a file beside the model, or None where it is embedded."""

    path: Path | None


@dataclass(frozen=True, slots=True)
class GltfEmitter:
    """One source of one emitter, as components of a scene.

    Attributes:
        source: Number of the source in the file.
        audio: Number of its data.
        sound: Values of the component `sound`, but for its asset.
        emitter: Values of the component `sound_emitter`, but for its sound.
    """

    source: int
    audio: int
    sound: dict[str, Any]
    emitter: dict[str, Any]


@dataclass(frozen=True)
class GltfSounds:
    """All sounds of a file.

    Attributes:
        audio: Data, in file order.
        emitters: Sources of each emitter, in file order.
        of_nodes: Emitter of a node, by the node's index.
        of_scene: Emitters of the default scene, audible everywhere.
    """

    audio: list[GltfAudio]
    emitters: list[list[GltfEmitter]]
    of_nodes: dict[int, int]
    of_scene: list[int]


def read_sounds(source: GltfSource, buffers: GltfBuffers) -> GltfSounds | None:
    """Read the sounds of a file, None where it has none; faults are collected."""
    holder = source.extension(source.json, EXTENSION, "")
    if not holder:
        return None
    reader = _Reader(source, buffers, holder)
    audio = source.read_each(reader.table("audio"), f"{_PLACE}/audio", reader.audio, lambda: GltfAudio(None))
    read = partial(reader.source, count=len(audio))
    played = source.read_each(reader.table("sources"), f"{_PLACE}/sources", read, lambda: None)
    emitter = partial(reader.emitter, played=played)
    emitters = source.read_each(reader.table("emitters"), f"{_PLACE}/emitters", emitter, list[GltfEmitter])
    return GltfSounds(audio, emitters, reader.of_nodes(len(emitters)), reader.of_scene(len(emitters)))


def read_embedded_sound(path: Path, number: int) -> bytes:
    """Return the data of an embedded sound, as in a file of its own.

    Raises:
        GltfError: The model cannot be read any more.
    """
    source = open_gltf(path, path.parent, str(path))
    holder = source.extension(source.json, EXTENSION, "")
    place = f"{_PLACE}/audio/{number}"
    table = source.list(holder, "audio", _PLACE)
    item = table[source.index(number, len(table), "audio", place)]
    return _embedded(source, GltfBuffers(source), item, place)


def _embedded(source: GltfSource, buffers: GltfBuffers, item: dict[str, Any], place: str) -> bytes:
    if "bufferView" in item:
        return bytes(buffers.view(item["bufferView"], f"{place}/bufferView")[0])
    return data_uri(source, source.text(item, "uri", place), f"{place}/uri")


def _is_sound(head: bytes) -> bool:
    """True when data begins with the signature of WAV, OGG, FLAC or MP3."""
    known = (b"OggS", b"fLaC", b"ID3", b"\xff\xfb", b"\xff\xf3", b"\xff\xf2", b"\xff\xfa")
    return (head[:4] == b"RIFF" and head[8:12] == b"WAVE") or head.startswith(known)


class _Reader:
    """Reader of the lists of the extension."""

    def __init__(self, source: GltfSource, buffers: GltfBuffers, holder: dict[str, Any]) -> None:
        self._source = source
        self._buffers = buffers
        self._holder = holder

    def table(self, name: str) -> list[Any]:
        """Return a list of the extension; a faulty one is reported and taken as empty."""
        table: list[Any] = []
        with self._source.collecting():
            table = self._source.list(self._holder, name, _PLACE)
        return table

    def audio(self, item: dict[str, Any], place: str) -> GltfAudio:
        """Locate the data of a sound; embedded data must have a known signature, nothing is decoded."""
        source = self._source
        if "bufferView" in item and item.get("mimeType") not in _TYPES:
            source.fail(f"{place}/mimeType", f"{item.get('mimeType')!r:.40} is not one of {', '.join(_TYPES)}")
        if "bufferView" not in item and "uri" not in item:
            source.fail(place, "has neither a uri nor a bufferView")
        uri = source.text(item, "uri", place)
        if "bufferView" not in item and uri[:5].lower() != "data:":
            return GltfAudio(source.external(uri, f"{place}/uri"))
        if not _is_sound(_embedded(source, self._buffers, item, place)[:12]):
            source.fail(place, "is not a sound: neither WAV, MP3, OGG nor FLAC")
        return GltfAudio(None)

    def source(self, item: dict[str, Any], place: str, count: int) -> GltfEmitter:
        """Read a source that refers to one of `count` sounds."""
        audio = self._source.index(item.get("audio"), count, "audio", f"{place}/audio")
        loop, autoplay = self._flag(item, "loop", place), self._flag(item, "autoPlay", place)
        gain, number = {"gain": self._gain(item, place)}, int(place.rpartition("/")[2])
        return GltfEmitter(number, audio, gain, {"loop": loop, "autoplay": autoplay})

    def emitter(self, item: dict[str, Any], place: str, played: list[GltfEmitter | None]) -> list[GltfEmitter]:
        """Read an emitter: one item for each of its sources."""
        source, kind = self._source, self._source.choice(item, "type", place, ("global", "positional"))
        if kind == "global" and "positional" in item:
            source.fail(f"{place}/positional", "a global emitter has no position")
        shape = self._shape(item, f"{place}/positional") if kind == "positional" else {}
        radiated = shape | {"gain": self._gain(item, place)}
        numbers = [
            source.index(value, len(played), "sources", f"{place}/sources/{k}")
            for k, value in enumerate(source.list(item, "sources", place))
        ]
        spatial = {"spatial": kind == "positional"}
        each = [found for found in map(played.__getitem__, numbers) if found is not None]
        return [replace(found, sound=found.sound | spatial, emitter=found.emitter | radiated) for found in each]

    def _shape(self, item: dict[str, Any], place: str) -> dict[str, Any]:
        """Return the values of `sound_emitter` for distance and direction."""
        source = self._source
        said = source.object(item, "positional", place.rpartition("/")[0])
        shape = source.choice(said, "shapeType", place, ("omnidirectional", "cone"), "omnidirectional")
        model = source.choice(said, "distanceModel", place, _MODELS, "inverse")
        nearest = source.number(said, "refDistance", place, 1.0, 0.0)
        if not 0.0 < nearest <= _MAX_DISTANCE:
            source.fail(f"{place}/refDistance", f"{nearest:g} m is not between 0 and {_MAX_DISTANCE:g}")
        farthest = source.number(said, "maxDistance", place, 0.0, 0.0) or _MAX_DISTANCE
        if model == "linear" and not nearest < farthest:
            source.fail(f"{place}/maxDistance", f"{farthest:g} m is not beyond the refDistance of {nearest:g} m")
        rolloff = min(
            source.number(said, "rolloffFactor", place, 1.0, 0.0), 1.0 if model == "linear" else _MAX_DISTANCE
        )
        spread = {"reference_distance": nearest, "max_distance": min(farthest, _MAX_DISTANCE), "rolloff": rolloff}
        cone = self._cone(said, place) if shape == "cone" else {}
        return {**spread, "distance_model": model, **cone}

    def _cone(self, said: dict[str, Any], place: str) -> dict[str, Any]:
        source = self._source
        inner = source.number(said, "coneInnerAngle", place, math.tau, 0.0)
        outer = source.number(said, "coneOuterAngle", place, math.tau, 0.0)
        behind = source.number(said, "coneOuterGain", place, 0.0, 0.0)
        if not inner <= outer <= _WHOLE:
            source.fail(f"{place}/coneInnerAngle", f"cones of {inner:g} and {outer:g} rad are not nested")
        if behind > 1.0:
            source.fail(f"{place}/coneOuterGain", f"{behind:g} is not between 0 and 1")
        return {"cone_inner": inner, "cone_outer": outer, "cone_gain": behind}

    def _gain(self, item: dict[str, Any], place: str) -> float:
        gain = self._source.number(item, "gain", place, 1.0, 0.0)
        if gain > _MAX_GAIN:
            self._source.note(f"{place}: a gain of {gain:g} was taken as {_MAX_GAIN:g}")
        return min(gain, _MAX_GAIN)

    def _flag(self, item: dict[str, Any], key: str, place: str) -> bool:
        value = item.get(key, False)
        if not isinstance(value, bool):
            self._source.fail(f"{place}/{key}", "must be true or false")
        return value

    def of_nodes(self, count: int) -> dict[int, int]:
        """Return the emitter of each node that has one."""
        found = {}
        for i, node in enumerate(self._source.table("nodes")):
            place = f"/nodes/{i}/extensions"
            with self._source.collecting():
                said = self._source.extension(node, EXTENSION, f"/nodes/{i}")
                if "emitter" in said:
                    where = f"{place}/{EXTENSION}/emitter"
                    found[i] = self._source.index(said["emitter"], count, "emitters", where)
        return found

    def of_scene(self, count: int) -> list[int]:
        """Return the emitters of the default scene, which must be global; those of other scenes are checked, too."""
        found: dict[int, list[int]] = {}
        for i, scene in enumerate(self._source.table("scenes")):
            place = f"/scenes/{i}/extensions"
            with self._source.collecting():
                said = self._source.extension(scene, EXTENSION, f"/scenes/{i}")
                for k, value in enumerate(self._source.list(said, "emitters", f"{place}/{EXTENSION}")):
                    where = f"{place}/{EXTENSION}/emitters/{k}"
                    index = self._source.index(value, count, "emitters", where)
                    if self._source.entry(self.table("emitters")[index], where).get("type") != "global":
                        self._source.fail(where, f"emitter {index} is positional: it belongs to a node")
                    found.setdefault(i, []).append(index)
        chosen = self._source.json.get("scene", 0)
        return found.get(chosen, []) if isinstance(chosen, int) else []
