"""House of an alley, seen from close by: windows with frames and shutters, doors with panels, all of it geometry."""

from __future__ import annotations

from dataclasses import dataclass

from assets.builders.city.textures import TILE
from assets.builders.kit.facade import Opening, Zone, add_zone, wall_axes
from assets.builders.kit.sketch import Sketch, Uv
from assets.builders.kit.solids import ALONG_X, Skin, add_column, add_prism

__all__ = ["HouseFront", "build_front"]

_DEPTH = 5.0
"""Depth of a house behind its front [m]."""
_GROUND, _STOREY = 2.9, 2.6
"""Heights of the ground floor and of each floor above [m]."""
_WINDOW, _DOOR = (0.92, 1.25), (0.98, 2.16)
"""Width and height of the openings [m]."""
_HEAD = 2.28
"""Upper edge of doors and of windows of the ground floor [m]."""
_UPPER_SILL = 0.85
"""Height of a window's sill above the floor of an upper storey [m]."""
_RECESS = 0.14
"""Depth of the reveals [m]."""
_PLINTH = 0.42
"""Height of the plinth [m]."""
_SLATS = 7
_OVERHANG, _RISE = 0.38, 2.1
"""Roof: how far it stands out over the alley, and height of its ridge above the eaves [m]."""
_STONE = Skin("stone", (1.2, 1.2))
_WALL_TILE = {"brick": (1.25, 1.5), "plaster": (2.4, 2.4)}
"""Metres one repetition of a wall's texture covers, less than in the city: it is seen from a step away."""


@dataclass(frozen=True)
class HouseFront:
    """What distinguishes one house from the next.

    Attributes:
        wall: Material of the wall.
        width: Along the alley [m].
        storeys: Floors, the ground floor included.
        bays: Openings side by side on each floor.
        door: Bay of the door; -1: none.
        paint: Material of shutters and door.
        shutters: Whether the windows have them.
    """

    wall: str
    width: float
    storeys: int
    bays: int
    door: int
    paint: str
    shutters: bool

    @property
    def eaves(self) -> float:
        """Height of the walls [m]."""
        return _GROUND + (self.storeys - 1) * _STOREY


def build_front(house: HouseFront, *, fine: bool = True) -> Sketch:
    """Build a house that stands on y = 0 at z < 0, centred in x, and faces +z.

    Args:
        house: The house.
        fine: False: a coarse form for a distance, with frames, shutters and door as flat faces.
    """
    front = _Front(house, fine=fine)
    front.add_ground_floor()
    for storey in range(1, house.storeys):
        front.add_upper_floor(_GROUND + (storey - 1) * _STOREY)
    _add_other_sides(front.sketch, house, front.wall)
    _add_roof(front.sketch, house, front.wall)
    side, rim = 0.5 * house.width - 0.12, 0.07
    sides = 8 if fine else 4
    add_column(front.sketch, (side, 0.0, rim), (side, house.eaves, rim), (0.045, 0.045), sides, _skin("zinc"))
    return front.sketch


def _skin(material: str, shade: float = 1.0) -> Skin:
    return Skin(material, shade=shade)


class _Front:
    """The side of a house with windows and a door, in the making.

    Args:
        house: The house.
        fine: See `build_front`.

    Attributes:
        sketch: Faces so far.
        wall: Skin of the wall.
    """

    def __init__(self, house: HouseFront, *, fine: bool) -> None:
        self.sketch = Sketch()
        self.wall = Skin(house.wall, _WALL_TILE[house.wall.rstrip("0123456789")])
        self._house, self._fine = house, fine
        self._axes = wall_axes(house.width, _DEPTH, "front")
        self._middles = [house.width * (bay + 0.5) / house.bays for bay in range(house.bays)]

    def add_ground_floor(self) -> None:
        """Add windows, a door and the plinth."""
        house, row = self._house, []
        for bay, middle in enumerate(self._middles):
            wide, high = _DOOR if bay == house.door else _WINDOW
            panel = _skin(house.paint if bay == house.door else "glass")
            row.append(Opening(middle - 0.5 * wide, middle + 0.5 * wide, _HEAD - high, _HEAD, panel, _RECESS))
        self._add_zone(0.0, _GROUND, row, footed=True)
        for bay, opening in enumerate(row):
            if bay == house.door:
                self._add_door(opening)
            else:
                self._add_window(opening)
        self._add_plinth(row[house.door] if house.door >= 0 else None)

    def add_upper_floor(self, floor: float) -> None:
        """Add a row of windows above a height [m]."""
        wide, high = _WINDOW
        bottom = floor + _UPPER_SILL
        row = [
            Opening(middle - 0.5 * wide, middle + 0.5 * wide, bottom, bottom + high, _skin("glass"), _RECESS)
            for middle in self._middles
        ]
        self._add_zone(floor, floor + _STOREY, row)
        for opening in row:
            self._add_window(opening)

    def _add_zone(self, bottom: float, top: float, row: list[Opening], *, footed: bool = False) -> None:
        roofed = 0.72 if top == self._house.eaves else 1.0
        zone = Zone(0.0, self._house.width, bottom, top, [row], self.wall, _STONE, footed=footed, roofed=roofed)
        add_zone(self.sketch, self._axes, zone)

    def _add_bar(self, low: Uv, high: Uv, reach: Uv, skin: Skin) -> None:
        """A block on the wall from `low` to `high`, over a reach outwards [m]; without the side that nobody sees."""
        (a0, b0), (a1, b1), (c0, c1) = low, high, reach
        faces = (
            ((a0, b0, c1), (a1, b0, c1), (a1, b1, c1), (a0, b1, c1), 1.0),
            ((a0, b0, c0), (a1, b0, c0), (a1, b0, c1), (a0, b0, c1), 0.55),
            ((a0, b1, c1), (a1, b1, c1), (a1, b1, c0), (a0, b1, c0), 1.0),
            ((a0, b0, c0), (a0, b0, c1), (a0, b1, c1), (a0, b1, c0), 0.9),
            ((a1, b0, c1), (a1, b0, c0), (a1, b1, c0), (a1, b1, c1), 0.9),
        )
        for first, second, third, fourth, shade in faces if self._fine else faces[:1]:
            corners = (first, second, third, fourth)
            places = skin.lay([(a + c, b + c) for a, b, c in corners])
            points = [self._axes.point(*corner) for corner in corners]
            self.sketch.fan(skin.material, points, places, shade * skin.shade)

    def _add_window(self, opening: Opening) -> None:
        """Frame, crossbars, sill and shutters."""
        left, right, bottom, top = opening.left, opening.right, opening.bottom, opening.top
        middle = 0.5 * (left + right)
        bars = [
            ((left, bottom), (right, bottom + 0.07)),
            ((left, top - 0.06), (right, top)),
            ((left, bottom + 0.07), (left + 0.06, top - 0.06)),
            ((right - 0.06, bottom + 0.07), (right, top - 0.06)),
            ((middle - 0.03, bottom + 0.07), (middle + 0.03, top - 0.06)),
            ((left + 0.06, top - 0.42), (right - 0.06, top - 0.38)),
        ]
        for low, high in bars:
            self._add_bar(low, high, (-_RECESS, -_RECESS + 0.045), _skin("frame"))
        self._add_bar((left - 0.06, bottom - 0.07), (right + 0.06, bottom), (-_RECESS, 0.08), _STONE)
        if self._house.shutters:
            half = 0.5 * (right - left)
            for edge in (left - half - 0.02, right + 0.02):
                self._add_shutter((edge, bottom), (edge + half, top))

    def _add_shutter(self, low: Uv, high: Uv) -> None:
        """An open shutter: a frame around slats."""
        (left, bottom), (right, top) = low, high
        paint = _skin(self._house.paint)
        self._add_bar(low, high, (0.0, 0.02), _skin(paint.material, 0.8))
        if not self._fine:
            return
        rails = [
            (low, (right, bottom + 0.06)),
            ((left, top - 0.06), high),
            ((left, bottom + 0.06), (left + 0.05, top - 0.06)),
            ((right - 0.05, bottom + 0.06), (right, top - 0.06)),
        ]
        for first, second in rails:
            self._add_bar(first, second, (0.02, 0.04), paint)
        step = (top - bottom - 0.12) / _SLATS
        for slat in range(_SLATS):
            edge = bottom + 0.06 + slat * step
            leaning = [
                self._axes.point(left + 0.05, edge, 0.036),
                self._axes.point(right - 0.05, edge, 0.036),
                self._axes.point(right - 0.05, edge + step, 0.021),
                self._axes.point(left + 0.05, edge + step, 0.021),
            ]
            self.sketch.fan(paint.material, leaning, [(0.0, 0.0)] * 4, [1.0, 1.0, 0.7, 0.7])

    def _add_door(self, opening: Opening) -> None:
        """A stone surround and a step; raised panels, a light above them, a handle."""
        left, right, bottom, top = opening.left, opening.right, opening.bottom, opening.top
        for low, high in (
            ((left - 0.14, 0.0), (left, top)),
            ((right, 0.0), (right + 0.14, top)),
            ((left - 0.14, top), (right + 0.14, top + 0.16)),
        ):
            self._add_bar(low, high, (0.0, 0.05), _STONE)
        self._add_bar((left, 0.0), (right, bottom), (-_RECESS, 0.16), _STONE)
        if not self._fine:
            return
        middle, deep, paint = 0.5 * (left + right), -_RECESS, _skin(self._house.paint, 1.15)
        for low_edge, high_edge in ((bottom + 0.14, bottom + 0.75), (bottom + 0.87, bottom + 1.55)):
            for first, second in ((left + 0.1, middle - 0.05), (middle + 0.05, right - 0.1)):
                self._add_bar((first, low_edge), (second, high_edge), (deep, deep + 0.03), paint)
        self._add_bar((left + 0.1, top - 0.4), (right - 0.1, top - 0.1), (deep, deep + 0.02), _skin("glass"))
        handle = (right - 0.09, bottom + 0.95)
        self._add_bar(handle, (handle[0] + 0.04, handle[1] + 0.15), (deep, deep + 0.06), _skin("zinc"))

    def _add_plinth(self, door: Opening | None) -> None:
        """A band of stone along the foot, interrupted by the door."""
        width = self._house.width
        gap = (door.left - 0.14, door.right + 0.14) if door else (width, width)
        for left, right in ((0.0, gap[0]), (gap[1], width)):
            if right > left:
                self._add_bar((left, 0.0), (right, _PLINTH), (0.0, 0.03), Skin("stone", _STONE.tile, shade=0.8))


def _add_other_sides(sketch: Sketch, house: HouseFront, wall: Skin) -> None:
    """Sides and back, without openings."""
    for side, length in (("left", _DEPTH), ("right", _DEPTH), ("back", house.width)):
        axes = wall_axes(house.width, _DEPTH, side)
        add_zone(sketch, axes, Zone(0.0, length, 0.0, house.eaves, [], wall, _STONE))


def _add_roof(sketch: Sketch, house: HouseFront, wall: Skin) -> None:
    """A gable with its ridge along the alley."""
    low, high, o = house.eaves, house.eaves + _RISE, _OVERHANG
    outline = [(-o, low), (_DEPTH + o, low), (_DEPTH + o, low + 0.14), (0.5 * _DEPTH, high), (-o, low + 0.14)]
    cover = Skin("tiles", TILE["tiles"])
    sides = (_skin("beam", 0.6), _skin("beam"), cover, cover, _skin("beam"))
    half = 0.5 * house.width
    add_prism(sketch, ALONG_X, outline, -half, half, (wall, wall), sides)
