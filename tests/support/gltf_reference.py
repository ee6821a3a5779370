"""Where the vertices of a glTF file are at a time, computed again: float64, plain loops, nothing of the product's."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Reference:
    """A file as it is, by the specification's text."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        self.binary = b""
        if data[:4] == b"glTF":
            length = struct.unpack_from("<I", data, 12)[0]
            self.json: dict[str, Any] = json.loads(data[20 : 20 + length])
            self.binary = data[20 + length + 8 :]
        else:
            self.json = json.loads(data)
        self.path = path

    def accessor(self, index: int) -> np.ndarray:
        entry = self.json["accessors"][index]
        kind, width = np.dtype(_TYPES[entry["componentType"]]), _SIZES[entry["type"]]
        values = np.zeros((entry["count"], width), kind)
        if "bufferView" in entry:
            view = self.json["bufferViews"][entry["bufferView"]]
            data = self._buffer(view["buffer"])
            step = view.get("byteStride", kind.itemsize * width)
            start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
            for i in range(entry["count"]):
                values[i] = np.frombuffer(data, kind, width, start + i * step)
        result = values.astype(np.float64)
        if entry.get("normalized"):
            result = np.maximum(result / np.iinfo(kind).max, -1.0)
        return result

    def posed(self, clip: str = "", at: float = 0.0) -> list[tuple[int, int, np.ndarray]]:
        """(node, primitive, positions in the world) of all that is drawn, in the file's order of vertices."""
        local = [self._local(node) for node in self.json["nodes"]]
        morphs = [self._rest_weights(node) for node in self.json["nodes"]]
        for animation in self.json.get("animations", []):
            if clip and animation.get("name", "clip 0") == clip:
                self._animate(animation, at, local, morphs)
        world = self._world(local)
        found = []
        for index, node in enumerate(self.json["nodes"]):
            if "mesh" not in node or index not in world:
                continue
            for k, primitive in enumerate(self.json["meshes"][node["mesh"]]["primitives"]):
                found.append((index, k, self._vertices(primitive, node, world, index, morphs[index])))
        return found

    def _vertices(self, primitive: Any, node: Any, world: Any, index: int, morphs: Any) -> np.ndarray:
        attributes = primitive["attributes"]
        positions = self.accessor(attributes["POSITION"])
        for share, target in zip(morphs, primitive.get("targets", []), strict=False):
            positions = positions + share * self.accessor(target["POSITION"])
        points = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
        if "skin" not in node or "JOINTS_0" not in attributes:
            return (points @ world[index].T)[:, :3]
        skin = self.json["skins"][node["skin"]]
        inverse = self.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        matrices = [world[joint] @ inverse[j] for j, joint in enumerate(skin["joints"])]
        moved, total = np.zeros_like(positions), np.zeros(len(positions))
        number = 0
        while f"JOINTS_{number}" in attributes:
            joints = self.accessor(attributes[f"JOINTS_{number}"]).astype(int)
            weights = self.accessor(attributes[f"WEIGHTS_{number}"])
            for v in range(len(positions)):
                for k in range(4):
                    moved[v] += weights[v, k] * (matrices[joints[v, k]] @ points[v])[:3]
                    total[v] += weights[v, k]
            number += 1
        return moved / total[:, None]

    def _animate(self, animation: Any, at: float, local: list[Any], morphs: list[Any]) -> None:
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            target, path = channel["target"].get("node"), channel["target"]["path"]
            if target is None:
                continue
            times = self.accessor(sampler["input"])[:, 0]
            cubic = sampler.get("interpolation") == "CUBICSPLINE"
            values = self.accessor(sampler["output"]).reshape(len(times), 3 if cubic else 1, -1)
            value = _sample(times, values, at, sampler.get("interpolation", "LINEAR"), path == "rotation")
            if path == "weights":
                morphs[target] = value
            else:
                local[target] = {**local[target], path: value}

    def _local(self, node: Any) -> dict[str, Any]:
        if "matrix" in node:
            return {"matrix": np.array(node["matrix"], float).reshape(4, 4).T}
        return {
            "translation": np.array(node.get("translation", (0, 0, 0)), float),
            "rotation": np.array(node.get("rotation", (0, 0, 0, 1)), float),
            "scale": np.array(node.get("scale", (1, 1, 1)), float),
        }

    def _rest_weights(self, node: Any) -> Any:
        if "mesh" not in node:
            return []
        mesh = self.json["meshes"][node["mesh"]]
        return node.get("weights", mesh.get("weights", []))

    def _world(self, local: list[dict[str, Any]]) -> dict[int, np.ndarray]:
        found: dict[int, np.ndarray] = {}
        scene = self.json["scenes"][self.json.get("scene", 0)]
        waiting = [(root, np.eye(4)) for root in scene["nodes"]]
        while waiting:
            index, above = waiting.pop()
            found[index] = above @ _matrix(local[index])
            waiting += [(child, found[index]) for child in self.json["nodes"][index].get("children", [])]
        return found

    def _buffer(self, index: int) -> bytes:
        uri = self.json["buffers"][index].get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        return (self.path.parent / uri).read_bytes()


def _sample(times: np.ndarray, values: np.ndarray, at: float, kind: str, turns: bool) -> np.ndarray:
    middle = values.shape[1] // 2
    if at <= times[0] or at >= times[-1] or len(times) == 1:
        value = values[0 if at <= times[0] else -1, middle]
    else:
        k = int(np.searchsorted(times, at, side="right")) - 1
        span = times[k + 1] - times[k]
        t = (at - times[k]) / span
        a, b = values[k, middle], values[k + 1, middle]
        if kind == "STEP":
            value = a
        elif kind == "CUBICSPLINE":
            h = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2)
            value = h[0] * a + h[1] * span * values[k, 2] + h[2] * b + h[3] * span * values[k + 1, 0]
        elif turns:
            # Between unit quaternions: a file's rounding, 0.383 and 0.924, would bend the path (3.11, appendix C.4).
            a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
            b = -b if a @ b < 0 else b
            angle = np.arccos(min(1.0, float(a @ b)))
            value = a if angle < 1e-9 else (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)
        else:
            value = (1 - t) * a + t * b
    return value / np.linalg.norm(value) if turns else value


def _matrix(place: dict[str, Any]) -> np.ndarray:
    if "matrix" in place:
        return place["matrix"]
    x, y, z, w = place["rotation"] / np.linalg.norm(place["rotation"])
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn * place["scale"], place["translation"]
    return matrix
