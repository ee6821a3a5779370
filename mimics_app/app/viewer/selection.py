"""Selection in the viewer: the object under the pointer is selected, dragged, and saved at its new position."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mimics_app.app.viewer.shown import Shown
from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.figures.hud import Colour
from mimics_app.rendering.visual.overlay.layers import Arrow
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.raycast import cast_ray
from mimics_app.world.files.scene.scene_texts import is_written_in_file
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["Selection", "axis_under", "drag_offset", "gizmo_arrows"]

Ray = tuple[F8, F8]

_FLAT = 0.17
"""Sine of the angle to the horizon below which a floor is seen too flat for dragging along it."""
_UP = np.array([0.0, 1.0, 0.0])


_LENGTH = 0.34
"""Length of an arrow, in half heights of the picture at its depth."""
_FROM = 0.2
"""Share of an arrow from its base that cannot be grabbed, because all three meet there."""
_REACH_PX = 9.0
"""Distance from an arrow within which the pointer grabs it [px]."""
_TINTS: tuple[Colour, ...] = ((0.95, 0.30, 0.28, 1.0), (0.40, 0.85, 0.35, 1.0), (0.36, 0.58, 1.0, 1.0))
_FAINT = 0.35


def gizmo_arrows(place: F8, view: View, axis: int | None) -> list[Arrow]:
    """Return the arrows along x, y and z, of the same length on the screen at any distance.

    Args:
        place: Base of the arrows, world [m], [3].
        view: View of the camera.
        axis: 0, 1 or 2: movement is limited to this axis, and the others are faint; None: no limit.
    """
    vectors = _length(place, view) * np.eye(3)
    strength = [1.0 if axis in (None, number) else _FAINT for number in range(3)]
    return [
        Arrow(place, vector, (*tint[:3], share)) for vector, tint, share in zip(vectors, _TINTS, strength, strict=True)
    ]


def axis_under(place: F8, ray: tuple[F8, F8], view: View) -> int | None:
    """Return the axis of the arrow under the pointer, None where there is none.

    Args:
        place: Base of the arrows, world [m], [3].
        ray: Ray through the pointer.
        view: View of the camera.
    """
    origin, direction = ray[0], ray[1] / np.linalg.norm(ray[1])
    length = _length(place, view)
    shares = np.linspace(_FROM, 1.0, 24)
    points = place + length * shares[None, :, None] * np.eye(3)[:, None, :]
    along = np.maximum((points - origin) @ direction, 1e-9)
    across = np.linalg.norm(points - origin - along[..., None] * direction, axis=-1)
    _, _, bottom, top = view.tangents
    pixels = across / along / ((top - bottom) / view.rectangle[3])
    nearest = pixels.min(axis=1)
    return int(np.argmin(nearest)) if nearest.min() <= _REACH_PX else None


def _length(place: F8, view: View) -> float:
    depth = float((view.eye_world - place) @ view.world_from_eye[:3, 2])
    return _LENGTH * max(depth, view.near) * 0.5 * (view.tangents[3] - view.tangents[2])


class Selection:
    """Selection and movement of nodes.

    Attributes:
        chosen: The selected node, or None.
        axis: 0, 1 or 2: the node moves along x, y or z; None: along the floor, or across the view where that is flat.
    """

    def __init__(self, shown: Shown) -> None:
        self._shown = shown
        self.chosen: SceneNode | None = None
        self.axis: int | None = None
        self._handle: int | None = None
        self._grip: tuple[F8, F8] | None = None
        self._undo: list[tuple[SceneNode, F8]] = []

    @property
    def holding(self) -> bool:
        """Whether something is being dragged."""
        return self._grip is not None

    def show(self, shown: Shown) -> None:
        """Switch to the reloaded file; the selection is kept where it still exists."""
        name = self.chosen.name if self.chosen is not None else ""
        self._shown, self._grip = shown, None
        self._undo.clear()
        self.chosen = shown.world.find(name) if name and name in shown.world else None

    def choose(self, ray: Ray) -> SceneNode | None:
        """Select the first entity of the scene file, or part of the model, on a ray; None where there is none."""
        self.chosen = self._under(ray)
        return self.chosen

    def grab(self, ray: Ray, view: View) -> bool:
        """Begin to drag if the ray hits the selected node or one of its arrows; return whether it does."""
        if self.chosen is None:
            return False
        place = self.chosen.world_matrix()[:3, 3]
        found = axis_under(place, ray, view)
        self._handle = found if self.axis in (None, found) else None
        point = self._meets(ray, self.chosen) if self._handle is None else place + _along_axis(place, self._handle, ray)
        if point is None:
            return False
        self._grip = (point, self.chosen.position)
        self._undo.append((self.chosen, self.chosen.position))
        return True

    def drag(self, ray: Ray, view: View) -> None:
        """Move the dragged node so that the grabbed point follows a ray."""
        if self.chosen is None or self._grip is None:
            return
        point, before = self._grip
        offset = drag_offset(point, ray, view, self.axis if self._handle is None else self._handle)
        parent = self.chosen.parent
        turn = np.eye(3) if parent is None else parent.world_matrix()[:3, :3]
        place: F8 = before + np.linalg.solve(turn, offset)
        self.chosen.set_position(place.round(4))

    def handles(self, view: View) -> list[Arrow]:
        """Return the arrows of the gizmo at the selected node."""
        if self.chosen is None:
            return []
        axis = self._handle if self.holding and self._handle is not None else self.axis
        return gizmo_arrows(self.chosen.world_matrix()[:3, 3], view, axis)

    def release(self) -> SceneNode | None:
        """End the drag; return the node if it was moved."""
        if self._grip is None or self.chosen is None:
            return None
        before, self._grip = self._grip[1], None
        if np.array_equal(before, self.chosen.position):
            self._undo.pop()
            return None
        return self.chosen

    def undo(self) -> bool:
        """Undo the last move of a part of a model; return False where there is none."""
        if not self._undo or self.holding:
            return False
        node, place = self._undo.pop()
        node.set_position(place)
        return True

    def _under(self, ray: Ray) -> SceneNode | None:
        return next((owner for owner, _ in self._hits(ray)), None)

    def _meets(self, ray: Ray, node: SceneNode) -> F8 | None:
        """Return the first intersection of a ray with a node's meshes; None where another node is in front."""
        return next((point if owner == node else None for owner, point in self._hits(ray)), None)

    def _hits(self, ray: Ray) -> Iterator[tuple[SceneNode, F8]]:
        for hit in cast_ray(self._shown.world, *ray):
            owner = self._owner(self._shown.world.node(hit.entity))
            if owner is not None:
                yield owner, hit.point_world

    def _owner(self, node: SceneNode) -> SceneNode | None:
        """Return the entity of the scene file, or the part of the model, that a node belongs to."""
        shown = self._shown
        if shown.scene is None:
            inside = shown.stand is not None and shown.world.graph.hierarchy.is_inside(node.index, shown.stand.index)
            return node if inside else None
        above: SceneNode | None = node
        while above is not None and not is_written_in_file(shown.scene, above.name):
            above = above.parent
        return above


def drag_offset(point: F8, ray: Ray, view: View, axis: int | None) -> F8:
    """Return the displacement that keeps a grabbed point under the pointer, world [m], [3].

    Args:
        point: Grabbed point, world [m], [3].
        ray: Ray through the pointer now.
        view: View of the camera.
        axis: 0, 1 or 2 for movement along x, y or z; None for a plane, horizontal or across the view.
    """
    origin, direction = ray
    if axis is not None:
        return _along_axis(point, axis, ray)
    forward = -view.world_from_eye[:3, 2]
    normal = _UP if abs(forward[1]) > _FLAT else forward
    facing = float(normal @ direction)
    if abs(facing) < 1e-9:
        return np.zeros(3)
    distance = float(normal @ (point - origin)) / facing
    return np.asarray(origin + distance * direction - point) if distance > 0.0 else np.zeros(3)


def _along_axis(point: F8, axis: int, ray: Ray) -> F8:
    """Return the displacement along an axis to the point nearest to a ray; zero where both are parallel."""
    (origin, direction), line = ray, np.eye(3)[axis]
    across = direction - (direction @ line) * line
    square = float(across @ across)
    if square < 1e-9 * float(direction @ direction):
        return np.zeros(3)
    away = point - origin
    # The ray's parameter at its point nearest to the line, then the projection of that point onto the line.
    parameter = float((away - (away @ line) * line) @ across) / square
    nearest = origin + parameter * direction
    return np.asarray(((nearest - point) @ line) * line)
