"""Line figures of the overlay: boxes and spheres around bodies, and the volumes of lights."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.draw_list import DRAWN, HIDDEN, DrawList
from mimics_app.rendering.visual.figures.hud import Colour
from mimics_app.rendering.visual.overlay.line_set import LineSet, box_lines, circle_lines
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World
from mimics_app.world.graph.light import Light

__all__ = ["add_bounds", "add_lights", "add_node_bounds"]


_DRAWN: Colour = (0.20, 0.92, 0.72, 0.75)
_HIDDEN: Colour = (1.0, 0.46, 0.20, 0.85)
_ROUND: Colour = (0.55, 0.70, 1.0, 0.40)
_CHOSEN: Colour = (1.0, 0.85, 0.25, 1.0)
_LIGHT: Colour = (1.0, 0.88, 0.35, 0.9)

_MAX_BOUNDS = 500
"""Maximum number of items whose bounds are drawn, the largest on the screen first."""
_BOUNDLESS = 0.5
"""Radius of the figure of a light without a range [m]."""
_SUN_RAYS = ((0.0, 0.0), (0.12, 0.0), (-0.12, 0.0), (0.0, 0.12), (0.0, -0.12))


def add_bounds(lines: LineSet, listed: DrawList, world: F8, view: View) -> None:
    """Add boxes of drawn and of occluded items, in two colours, and circles of the drawn items' spheres.

    Args:
        lines: Lines to add to.
        listed: Draw list of the frame, with fates.
        world: T_world_from_node per row, [rows, 4, 4].
        view: The view.
    """
    fates = listed.fates
    if fates is None:
        return
    away = np.linalg.norm(listed.centres - view.eye_world, axis=1)
    angles = np.where(fates > 0, listed.radii / np.maximum(away, view.near), 0.0)
    largest = np.argsort(-angles)[:_MAX_BOUNDS]
    axes = view.world_from_eye[:3, :3]
    for fate, tint in ((DRAWN, _DRAWN), (HIDDEN, _HIDDEN)):
        items = largest[fates[largest] == fate]
        lines.add(_boxes(listed.items, items, world), tint)
    items = largest[fates[largest] == DRAWN]
    radii = listed.radii[items, None]
    lines.add(circle_lines(listed.centres[items], radii * axes[:, 0], radii * axes[:, 1]), _ROUND, 1.0)


def add_node_bounds(lines: LineSet, world: World, listed: DrawList, node: int) -> None:
    """Add boxes of everything on and below a node, given by its entity index."""
    entities = world.subentities().entity
    inside = {entity: world.graph.hierarchy.is_inside(entity, node) for entity in set(entities.tolist())}
    items = np.flatnonzero([inside[entity] for entity in entities.tolist()])
    lines.add(_boxes(listed.items, items, world.transforms.world), _CHOSEN, 2.4)


def add_lights(lines: LineSet, world: World, view: View) -> None:
    """Add spheres of point lights, cones of spot lights, and a few rays of the sun in front of the camera."""
    for light in world.lights:
        red, green, blue = light.colour
        brightest = max(red, green, blue, 1e-6)
        tint = tuple(0.35 + 0.65 * part / brightest for part in (red, green, blue))
        own: Colour = (tint[0], tint[1], tint[2], 0.9)
        if light.kind == "point":
            _add_sphere(lines, light, own)
        elif light.kind == "spot":
            _add_cone(lines, light, own)
        elif light.kind == "directional":
            _add_sun(lines, light, view)


def _boxes(items: DrawItems, numbers: NDArray[np.intp], world: F8) -> F8:
    return box_lines(world[items.rows[numbers]], items.local[numbers, :3], items.half[numbers])


def _add_sphere(lines: LineSet, light: Light, tint: Colour) -> None:
    reach = light.range if math.isfinite(light.range) else _BOUNDLESS
    axes, centre = reach * np.eye(3), light.position_world[None]
    for first, second in ((0, 1), (1, 2), (2, 0)):
        lines.add(circle_lines(centre, axes[None, first], axes[None, second]), tint)
    star = 0.08 * min(reach, 2.0) * np.eye(3)
    lines.add(np.stack([centre - star, centre + star], axis=1), tint, 3.0)


def _add_cone(lines: LineSet, light: Light, tint: Colour) -> None:
    reach = light.range if math.isfinite(light.range) else 4.0 * _BOUNDLESS
    pose = light.node.world_matrix()[:3, :3]
    axes = pose / np.linalg.norm(pose, axis=0)
    place, centre = light.position_world, light.position_world - reach * math.cos(light.outer_cone) * axes[:, 2]
    for angle, strength in ((light.outer_cone, 1.0), (light.inner_cone, 0.45)):
        width, depth = reach * math.sin(angle), reach * math.cos(angle)
        rim = (place - depth * axes[:, 2])[None]
        own: Colour = (*tint[:3], strength * tint[3])
        lines.add(circle_lines(rim, width * axes[None, :, 0], width * axes[None, :, 1]), own)
    side = reach * math.sin(light.outer_cone)
    ends = [centre + sign * side * axes[:, axis] for axis in (0, 1) for sign in (1.0, -1.0)]
    lines.add(np.stack([np.broadcast_to(place, (4, 3)), np.array(ends)], axis=1), tint)


def _add_sun(lines: LineSet, light: Light, view: View) -> None:
    """Add five arrows along the light's direction in the upper part of the picture."""
    axes = view.world_from_eye[:3, :3]
    depth = 20.0 * view.near + 0.6
    _, right, _, top = view.tangents
    for across, along in _SUN_RAYS:
        place = np.array([(0.55 + across) * right, (0.60 + along) * top, -1.0]) * depth
        lines.arrow(view.eye_world + axes @ place, 0.16 * depth * light.direction_world, _LIGHT, 2.4)
