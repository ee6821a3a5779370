"""Kinds of houses: twenty, drawn from the building styles of a table; sizes and fittings differ with the seed."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from assets.builders.city.fittings import DOORS, SHOPS, SIGNS, WINDOWS
from assets.builders.kit.rng import Rng
from mimics_app.contracts.system.table_file import read_table_file

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


_STYLES = Path(__file__).with_suffix(".json")
"""Styles of houses in a row and of those at a corner."""


def draw_kinds(rng: Rng) -> list[HouseKind]:
    """The twenty kinds of a city: sixteen for rows, then two corners, each for both hands."""
    styles = read_table_file(_STYLES, dict[str, list[HouseKind]])
    varied_rows, varied_corners = ([_vary(style, rng) for style in styles[name]] for name in ("rows", "corners"))
    trades = itertools.cycle(range(SHOPS))  # no two kinds of houses near each other sell the same
    kinds = [_with_trade(kind, trades) for kind in varied_rows]
    for style, drawn in zip(styles["corners"], varied_corners, strict=True):
        varied = _with_trade(drawn, trades)
        kinds += [replace(varied, name=f"{style.name}_{side}", corner=side) for side in ("left", "right")]
    return kinds


def _with_trade(kind: HouseKind, trades: Iterator[int]) -> HouseKind:
    return replace(kind, shop=next(trades)) if kind.use == "shop" else kind


def _vary(style: HouseKind, rng: Rng) -> HouseKind:
    """The style with a little more or less of everything."""
    return replace(
        style,
        width=round(style.width + 0.3 * (rng.below(5) - 2), 1),
        ground=round(style.ground + 0.1 * (rng.below(4) - 1), 1),
        storey=round(style.storey + 0.05 * (rng.below(5) - 2), 2),
        rise=round(style.rise + 0.2 * (rng.below(4) - 1), 1) if style.roof != "flat" else style.rise,
        window=rng.below(WINDOWS),
        door=rng.below(DOORS),
        shop=rng.below(SHOPS),
        sign=rng.below(SIGNS),
    )
