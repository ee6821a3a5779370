"""One house from its kind: body with true windows, ground floor, ornaments; a coarse form of it; its inner box."""

from __future__ import annotations

from dataclasses import dataclass

from assets.builders.city.fittings import SHOPS, detail, plain, window
from assets.builders.city.house_kinds import HouseKind
from assets.builders.city.house_roofs import add_chimneys, add_dormers, add_roof
from assets.builders.city.textures import TILE
from assets.builders.kit.facade import Opening, Zone, add_zone, wall_axes
from assets.builders.kit.sketch import Point, Sketch
from assets.builders.kit.solids import UPRIGHT, Axes, Skin, add_prism, rectangle

__all__ = ["House", "build_house"]

_DEEPEST = 0.45
"""Depth of the deepest opening in the body [m]."""
_SOLID = 0.6
"""Distance of the occluder's sides from the walls [m]."""


@dataclass(frozen=True, eq=False)
class House:
    """The models of a kind of house.

    Attributes:
        kind: Description of the kind.
        fine: Its geometry; the house stands on y = 0 at z < 0 and faces +z.
        coarse: The same outline with windows in the texture.
        solid: Size and centre of a box inside its closed walls [m].
    """

    kind: HouseKind
    fine: Sketch
    coarse: Sketch
    solid: tuple[Point, Point]


def build_house(kind: HouseKind) -> House:
    """Build a kind."""
    fine, coarse = Sketch(), Sketch()
    _add_street_walls(fine, kind)
    _add_blind_walls(fine, kind)
    _add_ornaments(fine, kind)
    add_roof(fine, kind)
    add_chimneys(fine, kind)
    add_dormers(fine, kind)
    _add_coarse_body(coarse, kind)
    add_roof(coarse, kind)
    size = (kind.width - 2 * _SOLID, kind.eaves - 0.2, kind.depth - 2 * _SOLID)
    return House(kind, fine, coarse, (_rounded(size), _rounded((0.0, 0.5 * kind.eaves, -0.5 * kind.depth))))


def _wall_skin(kind: HouseKind) -> Skin:
    """Return the skin of its walls."""
    return Skin("wall", TILE[kind.wall])


def _rounded(point: Point) -> Point:
    return round(point[0], 4), round(point[1], 4), round(point[2], 4)


def _add_street_walls(sketch: Sketch, kind: HouseKind) -> None:
    """Walls with windows: the front, and the side of a corner house that looks at the other street."""
    for side in ("front", kind.corner) if kind.corner else ("front",):
        length = kind.width if side == "front" else kind.depth
        bays = kind.bays if side == "front" else _side_bays(kind)
        axes = wall_axes(kind.width, kind.depth, side)
        add_zone(sketch, axes, _ground_zone(kind, length, bays, door=side == "front"))
        add_zone(sketch, axes, _upper_zone(kind, length, bays, balconies=side == "front"))


def _middles(length: float, bays: int) -> list[float]:
    """Middles of evenly spaced windows."""
    return [length * (number + 0.5) / bays for number in range(bays)]


def _upper_zone(kind: HouseKind, length: float, bays: int, *, balconies: bool) -> Zone:
    rows = []
    wide, high = kind.pane
    s = kind.surround
    middles = [
        (bay, middle) for bay, middle in enumerate(_middles(length, bays)) if not (kind.oriel and bay == bays // 2)
    ]
    for floor in range(kind.floors):
        top = kind.ground + (floor + 1) * kind.storey - 0.55 + s
        row = []
        for bay, middle in middles:
            down = balconies and floor > 0 and bay in kind.balconies
            bottom = kind.ground + floor * kind.storey + 0.14 if down else max(top - high - 2 * s, kind.ground + 0.3)
            number = (kind.window + (bay * 5 + floor * 7) % 2 * 6) % 12  # one frame a house, but rooms differ
            left, right = middle - 0.5 * wide - s, middle + 0.5 * wide + s
            row.append(Opening(left, right, bottom, top, window(number), 0.2, s))
        rows.append(row)
    hidden = 1.0 if kind.roof in ("flat", "gabled_front", "stepped") else 0.7
    return Zone(0.0, length, kind.ground, kind.eaves, rows, _wall_skin(kind), plain("stone"), roofed=hidden)


def _ground_zone(kind: HouseKind, length: float, bays: int, *, door: bool) -> Zone:
    """Shop fronts between piers, or windows, and a door among them."""
    shop = kind.use == "shop"
    skin = _wall_skin(kind) if kind.use == "rooms" else Skin("stone", TILE["stone"])
    s = 0.0 if shop else kind.surround
    half = 0.5 * length / bays - 0.28 if shop else 0.5 * kind.pane[0] + s
    top = kind.ground - 0.75
    bottom = 0.12 if shop else max(0.8, top - kind.pane[1] - 2 * s)
    row = []
    entrance = (0 if shop else bays // 2) if door else -1
    for bay, middle in enumerate(_middles(length, bays)):
        panel = detail("shop", (kind.shop + bay % 2 * 4) % SHOPS) if shop else window((kind.window + bay % 2 * 6) % 12)
        depth = 0.3 if shop else 0.2
        if bay == entrance:
            row.append(Opening(middle - half, middle + half, 0.12, top, detail("door", kind.door), _DEEPEST))
        else:
            row.append(Opening(middle - half, middle + half, bottom, top, panel, depth, s))
    return Zone(0.0, length, 0.0, kind.ground, [row], skin, plain("stone"), footed=True)


def _add_blind_walls(sketch: Sketch, kind: HouseKind) -> None:
    """Back and party walls, the top and the bottom: with the street's walls they close the body."""
    w, d, g, e = kind.width, kind.depth, kind.ground, kind.eaves
    left = [(0.0, e), (0.0, 0.0), (w, 0.0), (w, g), (w, e)]  # their right edge meets a wall that is parted at g
    right = [(w, e), (0.0, e), (0.0, g), (0.0, 0.0), (w, 0.0)]  # their left edge does
    plain_back = [(0.0, 0.0), (w, 0.0), (w, e), (0.0, e)]
    outline = {"left": left, "right": right, "": plain_back}[kind.corner]
    storeys = Skin("bay", (w / kind.bays, e / (kind.floors + 1)))
    back = wall_axes(w, d, "back")
    sketch.fan("bay", [back.point(u, v, 0.0) for u, v in outline], storeys.lay(outline), 0.95)
    for side, edge in (("left", left), ("right", right)):
        if side != kind.corner:
            axes, skin = wall_axes(w, d, side), _wall_skin(kind)
            edge = [(u * d / w, v) for u, v in edge]
            sketch.fan("wall", [axes.point(u, v, 0.0) for u, v in edge], skin.lay(edge), 0.9)
    flat = plain("lead")
    top = [(-0.5 * w, e, 0.0), (0.5 * w, e, 0.0), (0.5 * w, e, -d), (-0.5 * w, e, -d)]
    sketch.fan(flat.material, top, flat.lay([(x, -z) for x, _, z in top]))
    bottom = _bottom(kind)
    sketch.fan(flat.material, bottom, flat.lay([(x, z) for x, _, z in bottom]), 0.5)


def _bottom(kind: HouseKind) -> list[Point]:
    """The floor's outline, clockwise seen from above, with every corner of the walls that stand on it."""
    w, d = kind.width, kind.depth
    front = [wall_axes(w, d, "front").point(u, 0.0, 0.0) for u in _ground_zone(kind, w, kind.bays, door=True).foot]
    behind_left, behind_right = (-0.5 * w, 0.0, -d), (0.5 * w, 0.0, -d)
    if not kind.corner:
        return [behind_right, *front[::-1], behind_left]
    side = wall_axes(w, d, kind.corner)
    foot = [side.point(u, 0.0, 0.0) for u in _ground_zone(kind, d, _side_bays(kind), door=False).foot]
    if kind.corner == "left":
        return [behind_right, *front[::-1], *foot[-2::-1]]
    return [behind_left, *foot[::-1], *front[-2::-1]]


def _side_bays(kind: HouseKind) -> int:
    return max(2, round(kind.bays * kind.depth / kind.width))


def _add_ornaments(sketch: Sketch, kind: HouseKind) -> None:
    for side in ("front", kind.corner) if kind.corner else ("front",):
        _add_courses(sketch, kind, side)
    if kind.use == "shop":
        _add_shop_sign(sketch, kind)
    middles = _middles(kind.width, kind.bays)
    for bay in kind.balconies:
        for floor in range(1, kind.floors):
            _add_balcony(sketch, middles[bay] - 0.5 * kind.width, kind.ground + floor * kind.storey, kind)
    if kind.oriel:
        _add_oriel(sketch, kind)


def _add_courses(sketch: Sketch, kind: HouseKind, side: str) -> None:
    """Plinth, band, cornice and corner stones of one street wall."""
    length = kind.width if side == "front" else kind.depth
    axes = wall_axes(kind.width, kind.depth, side)
    courses: list[tuple[float, float, float, float, float, Skin]] = []
    if kind.band:
        courses.append((0.0, length, kind.ground - 0.12, kind.ground + 0.16, 0.10, plain("stone")))
    if kind.cornice:
        courses.append((0.0, length, kind.eaves - 0.42, kind.eaves - 0.16, 0.14, plain("stone", 0.96)))
        courses.append((0.0, length, kind.eaves - 0.16, kind.eaves, 0.34, plain("stone")))
    if kind.quoins:
        low, high = kind.ground + 0.16, kind.eaves - 0.42
        courses += [(left, left + 0.45, low, high, 0.05, plain("stone")) for left in (0.0, length - 0.45)]
    for left, right, low, high, out, skin in courses:
        outline = rectangle(left, right, low, high)
        under = Skin(skin.material, cell=skin.cell, shade=0.55)
        add_prism(sketch, axes, outline, -0.02, out, (skin, skin), (under, skin, skin, skin))


def _add_shop_sign(sketch: Sketch, kind: HouseKind) -> None:
    """A board over the windows, and on some an awning."""
    half, low, high = 0.5 * kind.width - 0.3, kind.ground - 0.68, kind.ground - 0.16
    board = plain("wood", 0.7)
    outline = rectangle(-half, half, low, high)
    add_prism(sketch, Axes(), outline, -0.02, 0.12, (board, detail("sign", kind.shop)), (board,))
    if kind.shop % 2:
        along = Axes(a=(0.0, 0.0, 1.0), b=(0.0, 1.0, 0.0), c=(-1.0, 0.0, 0.0))
        outline = [(0.0, low - 0.1), (1.3, low - 0.5), (1.3, low - 0.44), (0.0, low)]
        stripes, dark = detail("awning", kind.shop % 4), plain("lead", 0.6)
        left = -0.5 * kind.width + kind.width / kind.bays + 0.2  # the door stays free
        add_prism(sketch, along, outline, -half, -left, (stripes, stripes), (dark, stripes, stripes, dark))


def _add_balcony(sketch: Sketch, middle: float, floor: float, kind: HouseKind) -> None:
    """A slab on the floor's height with a railing that is seen from both sides."""
    half, out = 0.5 * kind.pane[0] + 0.4, 0.95
    slab = rectangle(middle - half, middle + half, floor - 0.04, floor + 0.12)
    stone = plain("stone")
    add_prism(sketch, Axes(), slab, -0.02, out, (stone, stone), (plain("stone", 0.5), stone, stone, stone))
    low, high, edge = floor + 0.12, floor + 1.1, out - 0.05
    runs = [((-half, 0.0), (-half, edge)), ((-half, edge), (half, edge)), ((half, edge), (half, 0.0))]
    for (x0, z0), (x1, z1) in runs:
        length = abs(x1 - x0) + abs(z1 - z0)
        x0, x1 = middle + x0, middle + x1
        face = [(x0, low, z0), (x1, low, z1), (x1, high, z1), (x0, high, z0)]
        uvs = [(0.0, 1.0), (length, 1.0), (length, 0.0), (0.0, 0.0)]
        sketch.fan("railing", face, uvs)
        sketch.fan("railing", face[::-1], uvs[::-1])


def _add_oriel(sketch: Sketch, kind: HouseKind) -> None:
    """A projecting window over all floors of the middle bay, closed storey by storey."""
    middle = _middles(kind.width, kind.bays)[kind.bays // 2] - 0.5 * kind.width
    outline = [(-0.05, middle - 1.25), (0.9, middle - 0.75), (0.9, middle + 0.75), (-0.05, middle + 1.25)]
    face, lead = detail("oriel", kind.door % 4), plain("lead")
    for floor in range(kind.floors):
        low = kind.ground + floor * kind.storey - (0.0 if floor else 0.1)
        high = kind.ground + (floor + 1) * kind.storey - (0.3 if floor == kind.floors - 1 else 0.0)
        add_prism(sketch, UPRIGHT, outline, low, high, (plain("stone", 0.5), lead), (face,))


def _add_coarse_body(sketch: Sketch, kind: HouseKind) -> None:
    """The body as a box that wears pictures of its storeys."""
    w, d, e = kind.width, kind.depth, kind.eaves
    storeys = Skin("bay", (w / kind.bays, e / (kind.floors + 1)))
    outline = rectangle(-0.5 * w, 0.5 * w, 0.0, e)
    lead, wall = plain("lead"), _wall_skin(kind)
    sides = [lead, wall, lead, wall]
    for place, side in ((1, "right"), (3, "left")):
        if kind.corner == side:
            sides[place] = Skin("bay", (d / _side_bays(kind), e / (kind.floors + 1)))
    add_prism(sketch, Axes(), outline, -d, 0.0, (storeys, storeys), sides)
