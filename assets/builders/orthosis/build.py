"""The gait orthosis: treadmill, frame with body-weight support, harness, and for each leg bars, cuffs and drives."""

from __future__ import annotations

from collections.abc import Mapping

from assets.builders.kit.lattice_noise import hash_noise, pixels
from assets.builders.kit.palette_texture import Canvas
from assets.builders.orthosis.clinic import compose_clinic
from assets.builders.orthosis.harness import compose_harness
from assets.builders.orthosis.leg_parts import compose_drive, compose_foot, compose_rod, compose_shank, compose_thigh
from assets.builders.orthosis.standing_machine import compose_belt, compose_frame, compose_pelvis, compose_treadmill
from mimics_app.world.files.gltf.writer import GltfWriter, MeshPart

__all__ = ["compose"]

_FINISHES = {
    "paint": (0.38, 0.0),
    "plastic": (0.55, 0.0),
    "fabric": (1.0, 0.0),
    "metal": (0.34, 1.0),
    "screen": (0.25, 0.0),
}
"""Roughness and metallic share of each finish; colours are the vertices' own."""
_SIDES = {"left": 1.0, "right": -1.0}
_HIP_DRIVE, _HIP_ROD = 0.200, 0.185
_KNEE_DRIVE, _KNEE_ROD = 0.190, 0.175
"""Lengths of housings and rods: they overlap at the longest shaft, and do not meet the pivots at the shortest [m]."""


def compose(seed: int) -> dict[str, bytes]:
    """Return all files by name.

    Args:
        seed: Of the grain of belt and floor.
    """
    writer = GltfWriter("mimics_app assets build orthosis")
    materials = {
        name: writer.add_material(f"orthosis_{name}", roughness=rough, metallic=metallic)
        for name, (rough, metallic) in _FINISHES.items()
    }
    belt = writer.add_picture("belt", _paint_belt(seed))
    materials["belt"] = writer.add_material("orthosis_belt", texture=belt, roughness=0.95)
    for name, parts in _nodes().items():
        written = [(writer.add_part(part), materials[finish]) for finish, part in parts.items()]
        writer.add_node(name, mesh=writer.add_mesh(name, written))
    return {"orthosis.glb": writer.to_bytes(), "clinic.glb": compose_clinic(seed)}


def _nodes() -> dict[str, Mapping[str, MeshPart]]:
    """Return the parts of every node: what stands still, and what moves with the person."""
    nodes: dict[str, Mapping[str, MeshPart]] = {
        "belt": compose_belt().parts(),
        "treadmill": compose_treadmill().parts(),
        "frame": compose_frame().parts(),
        "pelvis": compose_pelvis().parts(),
        "harness": compose_harness().parts(),
        "hip_drive": compose_drive(_HIP_DRIVE).parts(),
        "hip_rod": compose_rod(_HIP_ROD).parts(),
        "knee_drive": compose_drive(_KNEE_DRIVE).parts(),
        "knee_rod": compose_rod(_KNEE_ROD).parts(),
    }
    for name, side in _SIDES.items():
        nodes[f"{name}_thigh"] = compose_thigh(side).parts()
        nodes[f"{name}_shank"] = compose_shank(side).parts()
        nodes[f"{name}_foot"] = compose_foot(side).parts()
    return nodes


def _paint_belt(seed: int) -> bytes:
    """Black rubber with pale edges, the same all along: marks that move are entities of the scene."""
    side = 256
    canvas = Canvas(side, side, [((12, 12, 13), (58, 58, 60)), ((120, 122, 124), (206, 208, 210))])
    x, y = pixels(side, side)
    canvas.tone = 0.42 + 0.10 * hash_noise(x // 2, y // 2, seed)
    edge = (x < 9) | (x >= side - 9)
    canvas.ramp[:] = edge.astype("uint8")
    canvas.tone = canvas.tone + 0.25 * edge
    canvas.grain(0.12, seed + 1)
    return canvas.to_png()
