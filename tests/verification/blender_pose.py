"""Run by a Python that has bpy: FILE OUT CLIP@S ...; writes where Blender has every vertex then, world [m], +y up.

Of each clip the file is read anew without the others: what a clip says nothing of Blender leaves as the clip before had
it, glTF as the nodes have it.
"""

from __future__ import annotations

import json
import re
import struct
import sys
import tempfile
from itertools import groupby
from pathlib import Path

import bpy
import numpy as np

FPS = 24


def _with_one_clip(file: Path, clip: str, folder: Path) -> Path:
    """A copy of a file, binary or with all its data within, that has no other clip."""
    data = file.read_bytes()
    binary = data[:4] == b"glTF"
    length = struct.unpack_from("<I", data, 12)[0] if binary else 0
    document = json.loads(data[20 : 20 + length] if binary else data)
    clips = document["animations"]
    document["animations"] = [each for k, each in enumerate(clips) if each.get("name", f"clip {k}") == clip]
    text = json.dumps(document).encode()
    if binary:
        text += b" " * (-len(text) % 4)
        rest = data[20 + length :]
        text = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest
    copy = folder / file.name
    copy.write_bytes(text)
    return copy


def _places() -> dict[str, np.ndarray]:
    """Of every object with a mesh; Blender numbers the second of a name."""
    graph, places = bpy.context.evaluated_depsgraph_get(), {}
    for thing in bpy.data.objects:
        if thing.type == "MESH":
            posed = thing.evaluated_get(graph)
            mesh = posed.to_mesh()
            flat = np.empty(3 * len(mesh.vertices))
            mesh.vertices.foreach_get("co", flat)
            world = np.array(posed.matrix_world)
            x, y, z = (flat.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]).T
            places[re.sub(r"\.\d+$", "", thing.name)] = np.stack([x, z, -y], axis=1)
            posed.to_mesh_clear()
    return places


def main(file: Path, out: str, asked: list[str]) -> None:
    found = {}
    for clip, group in groupby(asked, lambda each: each.rsplit("@", 1)[0]):
        with tempfile.TemporaryDirectory() as folder:
            bpy.ops.wm.read_factory_settings(use_empty=True)
            bpy.context.scene.render.fps = FPS
            bpy.ops.import_scene.gltf(filepath=str(_with_one_clip(file, clip, Path(folder))))
        for keys in bpy.data.shape_keys:
            for block in keys.key_blocks:
                block.slider_min, block.slider_max = -10.0, 10.0  # else Blender keeps shares within 0 and 1
        for each in group:
            frame = float(each.rsplit("@", 1)[1]) * FPS
            bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
            found |= {f"{each}/{name}": places for name, places in _places().items()}
    np.savez(out, **found)


main(Path(sys.argv[1]), sys.argv[2], sys.argv[3:])
