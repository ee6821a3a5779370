"""Kinds of houses: twenty, drawn from building styles; sizes and fittings differ with the seed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from mimics_app.builders.city.fittings import DOORS, SHOPS, SIGNS, WINDOWS
from mimics_app.builders.kit.chance import Chance

__all__ = ["HouseKind", "Roof", "draw_kinds"]

Roof = Literal["gable", "mansard", "flat", "gabled_front", "stepped", "hip"]


@dataclass(frozen=True)
class HouseKind:
    """What distinguishes one kind from another; lengths [m].

    Attributes:
        name: Its meshes' name.
        wall: "brick", "plaster" or "stone".
        width, depth: Of the body; it stands between its neighbours with its front to the street.
        ground, storey: Heights of the ground floor and of each floor above.
        floors: Floors above the ground floor.
        bays: Windows side by side.
        use: What the ground floor is: "shop", "rooms" (windows and a door) or "stone" (rooms behind blocks of stone).
        roof: Its form.
        rise: Height of the roof.
        pane: Width and height of a window.
        surround: Width of the stone frames about windows; 0: none.
        window, door, shop, sign: Designs.
        balconies: Bays that have one, on every floor above the first.
        oriel: A projecting window over the middle.
        dormers: On the street side of the roof.
        chimneys: On the ridge.
        cornice, band, quoins: Whether there are a cornice, a band over the ground floor, stone corners.
        slate: Slates instead of tiles.
        corner: Side that also looks at a street, seen from the front: "left", "right" or "".
    """

    name: str
    wall: str
    width: float
    depth: float = 12.0
    ground: float = 3.9
    storey: float = 3.2
    floors: int = 2
    bays: int = 3
    use: str = "rooms"
    roof: Roof = "gable"
    rise: float = 4.2
    pane: tuple[float, float] = (1.1, 1.8)
    surround: float = 0.0
    window: int = 0
    door: int = 0
    shop: int = 0
    sign: int = 0
    balconies: tuple[int, ...] = ()
    oriel: bool = False
    dormers: int = 0
    chimneys: int = 1
    cornice: bool = True
    band: bool = True
    quoins: bool = False
    slate: bool = False
    corner: str = ""

    @property
    def eaves(self) -> float:
        """Height of the walls [m]."""
        return self.ground + self.floors * self.storey


_STYLES = (
    HouseKind(
        "terrace",
        "brick",
        7.2,
        ground=3.2,
        storey=2.9,
        floors=1,
        bays=2,
        rise=3.6,
        pane=(1.2, 1.5),
        cornice=False,
        dormers=1,
    ),
    HouseKind("town", "brick", 9.6, use="stone", surround=0.14, dormers=2, slate=True),
    HouseKind(
        "merchant",
        "brick",
        7.8,
        storey=3.1,
        floors=3,
        bays=2,
        use="shop",
        roof="stepped",
        rise=4.8,
        pane=(1.2, 1.9),
        surround=0.14,
        cornice=False,
    ),
    HouseKind("corner_shop", "plaster", 10.8, use="shop", dormers=1),
    HouseKind(
        "founder",
        "plaster",
        12.9,
        ground=4.4,
        storey=3.6,
        floors=3,
        bays=4,
        use="stone",
        roof="mansard",
        rise=4.0,
        pane=(1.15, 2.1),
        surround=0.16,
        balconies=(2,),
        dormers=3,
        chimneys=2,
        quoins=True,
        slate=True,
    ),
    HouseKind(
        "parade",
        "plaster",
        14.4,
        ground=4.2,
        storey=3.3,
        floors=3,
        bays=4,
        use="shop",
        roof="mansard",
        rise=3.6,
        balconies=(1, 2),
        dormers=2,
        chimneys=2,
        slate=True,
    ),
    HouseKind(
        "gabled",
        "plaster",
        8.4,
        roof="gabled_front",
        rise=5.0,
        pane=(1.0, 1.7),
        cornice=False,
    ),
    HouseKind(
        "modern",
        "plaster",
        16.8,
        ground=3.6,
        storey=3.0,
        floors=3,
        bays=5,
        use="shop",
        roof="flat",
        rise=0.9,
        pane=(1.9, 1.7),
        balconies=(1, 3),
        chimneys=0,
        cornice=False,
        band=False,
    ),
    HouseKind(
        "oriel",
        "brick",
        9.0,
        storey=3.3,
        floors=3,
        oriel=True,
        surround=0.13,
        slate=True,
    ),
    HouseKind(
        "warehouse",
        "brick",
        13.2,
        ground=4.2,
        storey=3.5,
        floors=3,
        bays=4,
        use="shop",
        roof="flat",
        rise=1.1,
        pane=(1.9, 2.2),
        chimneys=0,
    ),
    HouseKind(
        "hall",
        "stone",
        15.6,
        ground=4.6,
        storey=3.9,
        bays=4,
        use="stone",
        roof="hip",
        rise=4.6,
        pane=(1.3, 2.3),
        surround=0.2,
        chimneys=2,
        slate=True,
    ),
    HouseKind(
        "cottage",
        "plaster",
        10.2,
        ground=3.1,
        storey=2.8,
        floors=1,
        rise=4.4,
        pane=(1.2, 1.4),
        cornice=False,
        band=False,
        dormers=2,
    ),
    HouseKind(
        "apartment",
        "brick",
        15.0,
        ground=3.6,
        storey=3.0,
        floors=3,
        bays=4,
        rise=3.4,
        pane=(1.5, 1.6),
        balconies=(0, 3),
        chimneys=2,
    ),
    HouseKind(
        "inn",
        "plaster",
        11.4,
        ground=3.8,
        storey=3.1,
        bays=4,
        use="shop",
        roof="gabled_front",
        rise=5.4,
        pane=(1.0, 1.6),
        cornice=False,
    ),
    HouseKind(
        "narrow",
        "brick",
        6.0,
        ground=3.8,
        floors=3,
        bays=2,
        use="shop",
        roof="gabled_front",
        rise=3.8,
        pane=(1.1, 1.9),
        surround=0.12,
        cornice=False,
    ),
    HouseKind(
        "bank",
        "stone",
        14.4,
        ground=4.8,
        storey=3.8,
        bays=4,
        use="stone",
        roof="flat",
        rise=1.2,
        pane=(1.2, 2.3),
        surround=0.18,
        balconies=(1, 2),
        chimneys=0,
        quoins=True,
    ),
)
_CORNERS = (
    HouseKind(
        "corner_founder",
        "plaster",
        14.4,
        ground=4.4,
        storey=3.5,
        floors=3,
        use="shop",
        roof="mansard",
        rise=4.0,
        pane=(1.6, 2.1),
        chimneys=2,
        slate=True,
        dormers=2,
    ),
    HouseKind(
        "corner_brick",
        "brick",
        13.2,
        ground=4.0,
        floors=3,
        use="shop",
        roof="hip",
        rise=4.4,
        surround=0.14,
    ),
)


def draw_kinds(chance: Chance) -> list[HouseKind]:
    """The twenty kinds of a city: sixteen for rows, then two corners, each for both hands."""
    kinds = [_vary(style, chance) for style in _STYLES]
    for style in _CORNERS:
        varied = _vary(style, chance)
        kinds += [replace(varied, name=f"{style.name}_{side}", corner=side) for side in ("left", "right")]
    return kinds


def _vary(style: HouseKind, chance: Chance) -> HouseKind:
    """The style with a little more or less of everything."""
    return replace(
        style,
        width=round(style.width + 0.3 * (chance.below(5) - 2), 1),
        ground=round(style.ground + 0.1 * (chance.below(4) - 1), 1),
        storey=round(style.storey + 0.05 * (chance.below(5) - 2), 2),
        rise=round(style.rise + 0.2 * (chance.below(4) - 1), 1) if style.roof != "flat" else style.rise,
        window=chance.below(WINDOWS),
        door=chance.below(DOORS),
        shop=chance.below(SHOPS),
        sign=chance.below(SIGNS),
    )
