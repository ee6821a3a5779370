"""What the nodes carry: bodies, lights, cameras and further components, as tables by entity index."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.levels import MAX_LEVELS
from mimics_app.world.light import LIGHT_KINDS, LightKind
from mimics_app.world.render_list import RenderList, SubEntityTable
from mimics_app.world.table import ComponentTable
from mimics_app.world.transforms import TransformTable

__all__ = ["Content"]

_NONE = -1


class Content:
    """Component tables. One entity has at most one component of each type.

    Attributes:
        bodies: `first` row and `count` of rows in `parts` of each Entity.
        parts: One row per SubEntity.
        lights, cameras: Their settings.
        occluders: Boxes inside a body, in its node's frame [m], that hide what is behind them: an author's word.
        levels: Of bodies with several levels of detail: how many, and the least coverage of the picture for each.
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
        """Have the render list made anew at the frame's end."""
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
            index: Of the node.
            levels: Finest first, at most `MAX_LEVELS`.
            coverages: Least share of the picture for each level, falling; below the last one nothing is shown.

        Raises:
            ValueError: a body is there already, or a number does not fit.
        """
        if not 0 < len(levels) == len(coverages) <= MAX_LEVELS or any(np.diff(coverages) >= 0.0):
            raise ValueError(f"{len(levels)} levels of detail for coverages {list(coverages)}")
        self.bodies.add(index, first=len(self.parts), count=sum(len(parts) for parts in levels))
        for level, parts in enumerate(levels):
            for mesh, material in parts:
                self.parts.append(index, mesh, material, level)
        padded = [*coverages, *[0.0] * (MAX_LEVELS - len(coverages))]
        self.levels.add(index, count=len(levels), coverages=padded)
        self.touch()

    def add_light(self, index: int, kind: LightKind, settings: dict[str, object]) -> None:
        """Let a light shine from a node.

        Raises:
            ValueError: one is there already.
            KeyError: a setting is not a column of the table.
        """
        values: dict[str, object] = {"colour": (1.0, 1.0, 1.0), "intensity": 1.0, "range": np.inf}
        values |= {"inner_cone": 0.0, "outer_cone": np.pi / 4}
        self.lights.add(index, kind=LIGHT_KINDS.index(kind), **(values | settings))

    def move_body(self, source: int, target: int) -> None:
        """Hang a body on another node.

        Raises:
            ValueError: a body is there already.
        """
        self.bodies.move(source, target)
        if source in self.levels:
            self.levels.move(source, target)
        owner = self.parts.owner[: len(self.parts)]
        owner[owner == source] = target
        self.touch()

    def drop(self, gone: NDArray[np.int32]) -> None:
        """Forget everything these entities carried."""
        for table in (self.lights, self.cameras, self.occluders, self.levels, *self.tables.values()):
            for index in gone.tolist():
                table.remove(index)
        self.drop_bodies(gone)

    def drop_bodies(self, gone: NDArray[np.int32]) -> None:
        """Stop showing bodies on these nodes, where there are any."""
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
        """The render list for this frame: `listed` again with new visibility, or a new one.

        Args:
            listed: The list of the last frame.
            transforms: After its update.
            moved: True when rows of `transforms` changed places.
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
