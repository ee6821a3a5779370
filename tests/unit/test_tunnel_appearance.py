"""Levels of detail of a tunnel's wall and middle line: none farther from the finest than it says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from trimesh.triangles import closest_point

from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from mimics_app.scenarios.parts.tunnel_appearance import TunnelAppearance
from mimics_app.world.components.visible import TunnelView
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.world import World

RADIUS, PICTURE = 0.03, 1920 * 1080
BENT = [[-0.2, 0.0, 0.0], [-0.1, 0.06, 0.02], [0.0, -0.05, 0.0], [0.1, 0.04, -0.03], [0.2, 0.0, 0.0]]


def make_appearance(points=BENT, rings: int = 16) -> tuple[World, TunnelAppearance]:
    world = World()
    world.set_material(Material("wall"))
    view = TunnelView(material="wall", bisector_material="wall", rings_per_piece=rings)
    node = world.root.create_child("tunnel")
    return world, TunnelAppearance(world, node, build_tunnel(points, [RADIUS, 0.02, RADIUS]), view, 1.0)


def corners_of(world: World, name: str) -> np.ndarray:
    mesh = world.meshes[name]
    return mesh.positions.astype(float)[mesh.indices.reshape(-1, 3)]


def off_surface(points: np.ndarray, corners: np.ndarray) -> float:
    """Farthest of some points from triangles [m]."""
    count = len(points)
    pairs = np.repeat(corners[None], count, axis=0).reshape(-1, 3, 3), np.repeat(points, len(corners), axis=0)
    away = np.linalg.norm(closest_point(*pairs) - pairs[1], axis=1)
    return float(away.reshape(count, -1).min(axis=1).max())


@pytest.mark.parametrize(("mesh", "node"), [("tunnel_wall", "tunnel"), ("tunnel_bisector", "tunnel_bisector")])
def test_at_its_least_coverage_a_form_is_half_a_pixel_off_at_most(mesh, node):
    world, _ = make_appearance()
    levels = world.content.levels
    coverages = levels.column("coverages")[levels.row(world.find(node).index)]
    fine = world.meshes[mesh]
    points = fine.positions.astype(float)[:: len(fine.positions) // 150]
    counts = [fine.triangle_count]
    for k in range(1, 5):
        corners = corners_of(world, f"{mesh}/{k}")
        counts.append(len(corners))
        pixel = fine.radius / math.sqrt(coverages[k - 1] * PICTURE / math.pi)
        assert off_surface(points, corners) <= 0.5 * pixel * (1.0 + 1e-3)
    assert counts == sorted(counts, reverse=True) and counts[-1] < 0.1 * counts[0]


def test_all_forms_are_widened_and_shown_anew_after_a_reload():
    world, appearance = make_appearance()
    before = {name: mesh.positions.copy() for name, mesh in world.meshes.items()}
    appearance.set_radius_scale(1.2)
    for name, was in before.items():
        assert np.array_equal(world.meshes[name].positions, was) == name.startswith("tunnel_bisector")
    node = world.find("tunnel")
    again = TunnelAppearance(world, node, build_tunnel(BENT[:4], RADIUS), TunnelView(material="wall"), 1.0)
    again.set_material("hidden")
    world.update()
    wall = node.entity
    assert wall is not None and len(wall.subentities) == 5 and not wall.visible
    assert all(part.casts_shadow for part in wall.subentities)
    line = world.find("tunnel_bisector").entity
    assert line is not None and not any(part.casts_shadow for part in line.subentities)
