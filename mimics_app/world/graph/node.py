"""Node: a handle on the place of an entity in the scene graph, and the base of handles on what a node carries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Self

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths import mat, quat
from mimics_app.maths.decompose import decompose_trs
from mimics_app.world.graph.handle import Handle

__all__ = ["Frame", "Node", "NodeComponent"]

Vector = Sequence[float] | F8
Frame = Literal["parent", "own"]
"""Axes of a movement: the parent's, or the node's own."""

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class Node(Handle):
    """Transform, parent and children. Structural edits reach the Transform table at the frame's end."""

    __slots__ = ()

    def _other(self, index: int) -> Self:
        return type(self)(self.world, self.world.graph.store.id_of(index))

    @property
    def name(self) -> str:
        """Name, unique in the world, or "" for none."""
        return self.world.graph.name(self.index)

    @property
    def parent(self) -> Self | None:
        """Parent node; None for the root and for detached nodes."""
        parent = self.world.graph.parent(self.index)
        return None if parent < 0 else self._other(parent)

    @property
    def children(self) -> list[Self]:
        """Child nodes, in the order they were attached."""
        return [self._other(child) for child in self.world.graph.hierarchy.children(self.index)]

    def create_child(
        self,
        name: str = "",
        position: Vector = (0.0, 0.0, 0.0),
        orientation: Vector = quat.IDENTITY,
        scale: Vector = (1.0, 1.0, 1.0),
    ) -> Self:
        """Create a child node: position [m], orientation xyzw, scale.

        Raises:
            TypeError: the name is not a text, or something in the place of a vector is none.
            ValueError: the name is taken, or a number is not finite. The node is removed at the frame's end.
        """
        child = self._other(self.world.graph.create(name, self.index))
        try:
            child.set_position(position)
            child.set_orientation(orientation)
            child.set_scale(scale)
        except (TypeError, ValueError):
            child.remove()
            raise
        return child

    def detach(self) -> None:
        """Take the node off its parent: it and its subtree stay, invisible, until attached again.

        Raises:
            ValueError: it is the root.
        """
        self.world.graph.detach(self.index)

    def remove(self) -> None:
        """Remove the node, its components and its subtree at the frame's end; their handles are stale from then on.

        Raises:
            ValueError: it is the root.
        """
        self.world.graph.queue_removal(self.index)

    @property
    def position(self) -> F8:
        """Local position [m], a copy, [3]."""
        return self.world.graph.transforms.translation(self.index)

    @property
    def orientation(self) -> F8:
        """Local orientation, unit xyzw with w >= 0, a copy, [4]."""
        return self.world.graph.transforms.rotation(self.index)

    @property
    def local_scale(self) -> F8:
        """Local scale, a copy, [3]."""
        return self.world.graph.transforms.scale(self.index)

    def set_position(self, position: Vector) -> None:
        """Set the local position [m], [3].

        Raises:
            ValueError: a number is not finite.
        """
        self.world.graph.transforms.set_translation(self.index, position)

    def set_orientation(self, orientation: Vector) -> None:
        """Set the local orientation, xyzw of any length, [4].

        Raises:
            ValueError: it is zero or not finite.
        """
        self.world.graph.transforms.set_rotation(self.index, orientation)

    def set_scale(self, scale: Vector) -> None:
        """Set the local scale, [3].

        Raises:
            ValueError: a number is not finite.
        """
        self.world.graph.transforms.set_scale(self.index, scale)

    def translate(self, offset: Vector, frame: Frame = "parent") -> None:
        """Move by an offset [m] in the parent's axes or the node's own (before its scale)."""
        step = np.array(offset, np.float64)
        if frame == "own":
            quat.rotate(self.orientation, step, step)
        self.set_position(self.position + step)

    def rotate(self, turn: Vector, frame: Frame = "own") -> None:
        """Rotate by a quaternion xyzw, about the node's own axes or the parent's."""
        now, by = self.orientation, quat.normalise_rows(np.asarray(turn, np.float64))
        if frame == "own":
            quat.multiply(now, by, now)
        else:
            quat.multiply(by, now, now)
        self.set_orientation(now)

    def yaw(self, angle: float, frame: Frame = "own") -> None:
        """Rotate by an angle [rad] about +y: positive to the left."""
        self.rotate(quat.about_axis(_Y, angle), frame)

    def pitch(self, angle: float, frame: Frame = "own") -> None:
        """Rotate by an angle [rad] about +x: positive looks up."""
        self.rotate(quat.about_axis(_X, angle), frame)

    def roll(self, angle: float, frame: Frame = "own") -> None:
        """Rotate by an angle [rad] about +z: positive tilts to the left."""
        self.rotate(quat.about_axis(_Z, angle), frame)

    def scale(self, factor: float | Vector) -> None:
        """Multiply the local scale by one factor or by three."""
        self.set_scale(self.local_scale * np.asarray(factor, np.float64))

    def look_at(self, target_world: Vector, up: Vector = _Y) -> None:
        """Rotate the node so that its -z points at a world point [m] and its +y leans towards `up`.

        Raises:
            ValueError: the target is where the node is.
        """
        here = self.world_matrix()
        goal = mat.look_at(here[:3, 3], target_world, up)[:3, :3]
        parent = self.parent
        if parent is not None:
            rotation = np.empty((4, 4))
            mat.compose_trs(np.zeros(3), decompose_trs(parent.world_matrix())[1], np.ones(3), rotation)
            goal = rotation[:3, :3].T @ goal
        orientation = np.empty(4)
        quat.from_matrix(goal, orientation)
        self.set_orientation(orientation)

    def world_matrix(self) -> F8:
        """T_world_from_node as it is now, also before the frame's end; a copy, [4, 4]."""
        return self.world.graph.world_matrix(self.index)

    @property
    def visible(self) -> bool:
        """Visibility flag of the node itself; False hides its subtree too."""
        return self.world.graph.transforms.is_visible(self.index)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self.world.graph.transforms.set_visible(self.index, visible=visible)


class NodeComponent(Handle):
    """Base of the handles on what a node carries."""

    __slots__ = ()

    @property
    def node(self) -> Node:
        """The node that carries it.

        Raises:
            StaleHandleError: the entity was removed.
        """
        found = self.world.node(self.index)
        assert isinstance(found, Node)
        return found
