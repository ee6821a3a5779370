"""Animations of a glTF file as clips, with every key checked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.contracts.errors import counted
from mimics_app.world.content.motion.clip import Clip, ClipEvent, Interpolation, MotionTrack, TrackPath, pack_clip
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.gltf.meshes import GltfMesh
from mimics_app.world.files.gltf.nodes import GltfNode

__all__ = ["MAX_CHANNELS", "GltfClips"]

MAX_CHANNELS = 40_000
"""Maximum number of channels of all animations together: 200 motions of 66 bones have as many."""
_AT_ONCE = np.float32(1e-6)
"""Time between keys of the same time [s]."""

_PATHS = {
    "translation": (TrackPath.TRANSLATION, "VEC3", 3),
    "rotation": (TrackPath.ROTATION, "VEC4", 4),
    "scale": (TrackPath.SCALE, "VEC3", 3),
    "weights": (TrackPath.WEIGHTS, "SCALAR", 1),
}
_KINDS = {"STEP": Interpolation.STEP, "LINEAR": Interpolation.LINEAR, "CUBICSPLINE": Interpolation.CUBIC}


def _apart(times: F4, first: int) -> F4:
    """Return times of which each is after the one before it: from a key on, those of one time follow within 1 us."""
    apart = times.copy()
    for n in range(first, len(apart)):
        if not apart[n] > apart[n - 1]:
            apart[n] = max(apart[n - 1] + _AT_ONCE, np.nextafter(apart[n - 1], np.float32(np.inf)))
    return apart


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
        self._check_count(animations)
        clips = self._source.read_each(animations, "/animations", self._read, lambda: None)
        return [clip for clip in clips if clip is not None]

    def _check_count(self, animations: list[dict[str, Any]]) -> None:
        """Refuse more channels, in all animations together, than can be read in a second or two."""
        found = 0
        for i, item in enumerate(animations):
            channels = item.get("channels")
            found += len(channels) if isinstance(channels, list) else 0
            if found > MAX_CHANNELS:
                self._source.fail(f"/animations/{i}/channels", f"the model has more than {MAX_CHANNELS} channels")

    def _read(self, item: dict[str, Any], place: str) -> Clip | None:
        tracks: dict[tuple[int, TrackPath], MotionTrack] = {}
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

    def _channel(self, item: dict[str, Any], channel: object, place: str, here: str) -> MotionTrack | None:
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
        return MotionTrack(node, _PATHS[path][0], _KINDS[kind], times, values)

    def _width(self, node: int, path: str, here: str) -> int:
        if path != "weights":
            return _PATHS[path][2]
        mesh = self._nodes[node].mesh
        return 0 if mesh is None else self._meshes[mesh].morphs

    def _times(self, sampler: dict[str, Any], where: str) -> F4:
        times = self._accessors.floats(sampler.get("input"), f"{where}/input", "SCALAR").reshape(-1)
        steps = np.diff(times)
        wrong = np.flatnonzero(steps < 0.0)
        if times[0] < 0.0:
            self._source.fail(f"{where}/input", f"begins at {times[0]:g} s, before 0")
        if wrong.size:
            after = int(wrong[0]) + 1
            self._source.fail(f"{where}/input", f"time {after}, {times[after]:g} s, is before the one before it")
        same = np.flatnonzero(steps == 0.0)
        if same.size:
            first = int(same[0]) + 1
            keys = counted(same.size, "keys")
            self._source.note(f"{where}/input: {keys} with the time of the one before, the first is {first}")
            times = _apart(times, first)
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
