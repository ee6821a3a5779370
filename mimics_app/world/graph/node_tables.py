"""Component tables by entity index: bodies, lights, cameras and further components of the nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import require_key
from mimics_app.world.graph.levels import MAX_LEVELS
from mimics_app.world.graph.render_list import RenderList, SubEntityTable
from mimics_app.world.graph.table import ComponentTable
from mimics_app.world.graph.transforms import TransformTable

__all__ = ["LIGHT_KINDS", "Content", "LightKind"]

LightKind = Literal["directional", "point", "spot", "ambient"]
LIGHT_KINDS: tuple[LightKind, ...] = ("directional", "point", "spot", "ambient")
"""In the order of the numbers in the light table's `kind` column."""

_NONE = -1


class Content:
    """Component tables. One entity has at most one component of each type.

    Attributes:
        bodies: `first` row and `count` of rows in `parts` of each Entity.
        parts: One row per SubEntity.
        lights, cameras: Settings of each light and camera.
        occluders: Boxes inside bodies, in their nodes' frames [m], declared by the author to hide what is behind them.
        levels: Number of levels of detail of a body with several, and the smallest coverage of the picture for each.
        tables: Further component tables by name, for scenarios and plug-ins.
    """

    def __init__(self) -> None:
        self.bodies = ComponentTable(first=(np.int32, ()), count=(np.int32, ()))
        self.parts = SubEntityTable()
        self.lights = ComponentTable(
            kind=(np.uint8, ()),
            colour=(np.float64, (3,)),
            intensity=(np.float64, ()),
            range=(np.float64, ()),
            inner_cone=(np.float64, ()),
            outer_cone=(np.float64, ()),
            casts_shadow=(np.uint8, ()),
        )
        self.cameras = ComponentTable(vertical_fov=(np.float64, ()), near=(np.float64, ()), far=(np.float64, ()))
        self.occluders = ComponentTable(centre=(np.float64, (3,)), size=(np.float64, (3,)))
        self.levels = ComponentTable(count=(np.int32, ()), coverages=(np.float64, (MAX_LEVELS,)))
        self.tables: dict[str, ComponentTable] = {}
        self._stale = True
        self._revision = 0

    def touch(self) -> None:
        """Mark the render list stale: it is rebuilt at the frame's end."""
        self._stale = True

    def add_body(self, index: int, parts: Sequence[tuple[str, str]]) -> None:
        """Show (mesh, material) parts on a node.

        Raises:
            ValueError: a body is there already.
        """
        self.bodies.add(index, first=len(self.parts), count=len(parts))
        for mesh, material in parts:
            self.parts.append(index, mesh, material)
        self.touch()

    def add_levels(self, index: int, levels: Sequence[Sequence[tuple[str, str]]], coverages: Sequence[float]) -> None:
        """Show one of several levels of (mesh, material) parts on a node, by how much of the picture it covers.

        Args:
            index: Entity index of the node.
            levels: Finest first, at most `MAX_LEVELS`.
            coverages: Smallest share of the picture for each level, decreasing; nothing is shown below the last one.

        Raises:
            ValueError: the node has a body already, or levels and coverages do not fit.
        """
        if not 0 < len(levels) == len(coverages) <= MAX_LEVELS or any(np.diff(coverages) >= 0.0):
            raise ValueError(f"{len(levels)} levels of detail need as many decreasing coverages, not {list(coverages)}")
        self.bodies.add(index, first=len(self.parts), count=sum(len(parts) for parts in levels))
        for level, parts in enumerate(levels):
            for mesh, material in parts:
                self.parts.append(index, mesh, material, level)
        padded = [*coverages, *[0.0] * (MAX_LEVELS - len(coverages))]
        self.levels.add(index, count=len(levels), coverages=padded)
        self.touch()

    def add_light(self, index: int, kind: LightKind, settings: dict[str, object]) -> None:
        """Put a light on a node.

        Raises:
            ValueError: the node has a light already, or a setting is not a number.
            KeyError: the kind is unknown, or a setting is not a column of the table.
        """
        require_key(kind, LIGHT_KINDS, "kind of light")
        values: dict[str, object] = {"colour": (1.0, 1.0, 1.0), "intensity": 1.0, "range": np.inf}
        values |= {"inner_cone": 0.0, "outer_cone": np.pi / 4}
        self.lights.add(index, kind=LIGHT_KINDS.index(kind), **(values | settings))

    def move_body(self, source: int, target: int) -> None:
        """Move a body, with its levels of detail and its occluder box, to another node.

        Raises:
            ValueError: a body is there already.
        """
        self.bodies.move(source, target)
        for table in (self.levels, self.occluders):
            if source in table and target not in table:
                table.move(source, target)
        owner = self.parts.owner[: len(self.parts)]
        owner[owner == source] = target
        self.touch()

    def drop(self, gone: NDArray[np.int32]) -> None:
        """Remove all components of these entities."""
        for table in (self.lights, self.cameras, self.occluders, self.levels, *self.tables.values()):
            for index in gone.tolist():
                table.remove(index)
        self.drop_bodies(gone)

    def drop_bodies(self, gone: NDArray[np.int32]) -> None:
        """Remove the bodies of these nodes, where there are any."""
        with_body = [index for index in gone.tolist() if index in self.bodies]
        if not with_body:
            return
        for index in with_body:
            self.bodies.remove(index)
            self.levels.remove(index)
        owner = self.parts.owner[: len(self.parts)]
        owner[np.isin(owner, with_body)] = _NONE
        old_rows = self.parts.compact()
        self.bodies.column("first")[:] = np.searchsorted(old_rows, self.bodies.column("first"))
        self.touch()

    def refresh(self, listed: RenderList | None, transforms: TransformTable, *, moved: bool) -> RenderList:
        """Return the render list of this frame: `listed` with new visibility, or a new one.

        Args:
            listed: Render list of the last frame.
            transforms: The Transform table, updated.
            moved: True when the rows of `transforms` were reordered.
        """
        count = len(self.parts)
        if listed is None or moved or self._stale:
            self._stale = False
            self._revision += 1
            owner = self.parts.owner[:count].copy()
            listed = RenderList(
                row=transforms.rows(owner),
                mesh=list(self.parts.mesh),
                material=list(self.parts.material),
                visible=np.empty(count, np.uint8),
                casts_shadow=self.parts.casts_shadow[:count].copy(),
                level=self.parts.level[:count].copy(),
                entity=owner,
                revision=self._revision,
            )
        np.bitwise_and(self.parts.visible[:count], transforms.shown[listed.row], out=listed.visible)
        return listed
