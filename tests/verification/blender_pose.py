"""Run by a Python that has bpy: FILE CLIP SECONDS OUT; writes where Blender has every vertex then, world [m], +y up."""

from __future__ import annotations

import sys

import bpy
import numpy as np

FPS = 24


def _play(clip: str) -> None:
    for thing in bpy.data.objects:
        keys = getattr(thing.data, "shape_keys", None) if thing.type == "MESH" else None
        for holder in (thing.animation_data, keys.animation_data if keys else None):
            for track in holder.nla_tracks if holder is not None else ():
                track.mute = True
                if track.name == clip:
                    holder.action, holder.action_slot = track.strips[0].action, track.strips[0].action_slot


def main(file: str, clip: str, seconds: float, out: str) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    bpy.ops.import_scene.gltf(filepath=file)
    _play(clip)
    frame = seconds * FPS
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    graph, places = bpy.context.evaluated_depsgraph_get(), []
    for thing in bpy.data.objects:
        if thing.type == "MESH":
            posed = thing.evaluated_get(graph)
            mesh = posed.to_mesh()
            flat = np.empty(3 * len(mesh.vertices))
            mesh.vertices.foreach_get("co", flat)
            world = np.array(posed.matrix_world)
            x, y, z = (flat.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]).T
            places.append(np.stack([x, z, -y], axis=1))
    np.savez(out, positions=np.concatenate(places))


main(sys.argv[1], sys.argv[2], float(sys.argv[3]), sys.argv[4])
