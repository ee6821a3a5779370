"""Animations of a glTF file as clips, with every key checked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.world.gltf.accessors import GltfAccessors
from mimics_app.world.gltf.gltf_document import GltfSource
from mimics_app.world.gltf.meshes import GltfMesh
from mimics_app.world.gltf.nodes import GltfNode
from mimics_app.world.motion.clip import Clip, ClipEvent, Interpolation, Track, TrackPath, pack_clip

__all__ = ["GltfClips"]


_PATHS = {
    "translation": (TrackPath.TRANSLATION, "VEC3", 3),
    "rotation": (TrackPath.ROTATION, "VEC4", 4),
    "scale": (TrackPath.SCALE, "VEC3", 3),
    "weights": (TrackPath.WEIGHTS, "SCALAR", 1),
}
_KINDS = {"STEP": Interpolation.STEP, "LINEAR": Interpolation.LINEAR, "CUBICSPLINE": Interpolation.CUBIC}


class GltfClips:
    """Reader of animations, in file order."""

    def __init__(
        self, source: GltfSource, accessors: GltfAccessors, nodes: Sequence[GltfNode], meshes: Sequence[GltfMesh]
    ) -> None:
        self._source = source
        self._accessors = accessors
        self._nodes = nodes
        self._meshes = meshes

    def read_all(self) -> list[Clip]:
        """Read every animation that moves a node; faults are collected. An unnamed one is "clip" and its number."""
        animations = self._source.table("animations")
        clips = self._source.read_each(animations, "/animations", self._read, lambda: None)
        return [clip for clip in clips if clip is not None]

    def _read(self, item: dict[str, Any], place: str) -> Clip | None:
        tracks: dict[tuple[int, TrackPath], Track] = {}
        for i, channel in enumerate(self._source.list(item, "channels", place)):
            with self._source.collecting():
                here = f"{place}/channels/{i}"
                track = self._channel(item, channel, place, here)
                if track is None:
                    continue
                if (track.target, track.path) in tracks:
                    self._source.fail(f"{here}/target", f"a second channel moves the same of node {track.target}")
                tracks[track.target, track.path] = track
        if not tracks:
            return None
        name = self._source.text(item, "name", place) or f"clip {place.rpartition('/')[2]}"
        return pack_clip(name, list(tracks.values()), self._events(item, place))

    def _channel(self, item: dict[str, Any], channel: object, place: str, here: str) -> Track | None:
        source = self._source
        channel = source.entry(channel, here)
        target = source.object(channel, "target", here)
        if "node" not in target or target.get("path") == "pointer":
            source.note(f"{here} left out: it moves no node")
            return None
        node = source.index(target["node"], len(self._nodes), "nodes", f"{here}/target/node")
        path = source.choice(target, "path", f"{here}/target", _PATHS)
        samplers = source.list(item, "samplers", place)
        number = source.index(channel.get("sampler"), len(samplers), "samplers", f"{here}/sampler")
        where = f"{place}/samplers/{number}"
        sampler = source.entry(samplers[number], where)
        kind = source.choice(sampler, "interpolation", where, _KINDS, "LINEAR")
        width = self._width(node, path, here)
        if width == 0:
            source.note(f"{here} left out: node {node} has no morph targets")
            return None
        times = self._times(sampler, where)
        values = self._values(sampler, where, path, width, len(times), _KINDS[kind])
        return Track(node, _PATHS[path][0], _KINDS[kind], times, values)

    def _width(self, node: int, path: str, here: str) -> int:
        if path != "weights":
            return _PATHS[path][2]
        mesh = self._nodes[node].mesh
        return 0 if mesh is None else self._meshes[mesh].morphs

    def _times(self, sampler: dict[str, Any], where: str) -> F4:
        times = self._accessors.floats(sampler.get("input"), f"{where}/input", "SCALAR").reshape(-1)
        wrong = np.flatnonzero(np.diff(times) <= 0.0)
        if times[0] < 0.0:
            self._source.fail(f"{where}/input", f"begins at {times[0]:g} s, before 0")
        if wrong.size:
            after = int(wrong[0]) + 1
            self._source.fail(f"{where}/input", f"time {after}, {times[after]:g} s, is not after the one before it")
        return times

    def _values(self, sampler: dict[str, Any], where: str, path: str, width: int, keys: int, kind: Interpolation) -> F4:
        """Return values as [keys, parts, width]: three parts for a cubic (in-tangent, value, out-tangent), else one."""
        source = self._source
        parts = 3 if kind is Interpolation.CUBIC else 1
        read = self._accessors.floats(sampler.get("output"), f"{where}/output", _PATHS[path][1])
        wanted = keys * parts * width
        if read.size != wanted:
            source.fail(f"{where}/output", f"has {read.size} numbers, {keys} keys need {wanted}")
        values = read.reshape(keys, parts, width)
        if path == "rotation":
            lengths = np.linalg.norm(values[:, parts // 2].astype(np.float64), axis=1)
            if lengths.min() < 1e-6:
                source.fail(f"{where}/output", f"key {int(np.argmin(lengths))} is a zero quaternion")
            # Before they are interpolated: between keys of other lengths the path bends.
            values = (values / lengths[:, None, None]).astype(np.float32)
        return values

    def _events(self, item: dict[str, Any], place: str) -> tuple[ClipEvent, ...]:
        """Read the events of `extras.mimics.events`: {"at", "kind", "node", "material", "strength"}."""
        source = self._source
        extras = item.get("extras")
        ours = source.object(extras, "mimics", f"{place}/extras") if isinstance(extras, dict) else {}
        here, found = f"{place}/extras/mimics/events", []
        for i, event in enumerate(source.list(ours, "events", f"{place}/extras/mimics")):
            where = f"{here}/{i}"
            event = source.entry(event, where)
            kind = source.text(event, "kind", where)
            if not kind:
                source.fail(where, 'the key "kind" is missing')
            at = source.number(event, "at", where, 0.0, 0.0)
            strength = source.number(event, "strength", where, 1.0, 0.0)
            node, material = source.text(event, "node", where), source.text(event, "material", where)
            found.append(ClipEvent(at, kind, node, material, strength))
        return tuple(sorted(found, key=lambda event: event.at))
