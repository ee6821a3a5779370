"""A town of 0.64 km^2: streets of houses, trees, furniture, a square with a church, a skyline, as one GLB file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assets.builders.city import furniture, landmark, layout, street_tree, streets
from assets.builders.city.house import House, build_house
from assets.builders.city.house_kinds import draw_kinds
from assets.builders.city.layout import Placed
from assets.builders.city.painted_materials import Colour, Painted, add_materials
from assets.builders.kit.rng import Rng
from assets.builders.kit.sketch import Sketch
from mimics_app.contracts.system.table_file import read_table_file
from mimics_app.world.files.gltf.writer import GltfWriter, WrittenPart

__all__ = ["TRIANGLES", "compose", "compose_city"]

TRIANGLES = 363_173
"""Number of triangles of the city of D2.1, 3.3.1; parked cars fill up the rest."""


@dataclass(frozen=True)
class Palette:
    """Materials of the city; colours are linear RGBA.

    Attributes:
        plain: By the names that sketches call them.
        walls: Tints of walls: matching colours; a kind of house has four consecutive ones.
        roofs: Tints of tiles.
        paints: Of cars.
    """

    plain: dict[str, Painted]
    walls: dict[str, list[Colour]]
    roofs: list[Colour]
    paints: dict[str, Colour]


_PALETTE = read_table_file(Path(__file__).with_name("materials.json"), Palette)
_COLOURS = 4
_HOUSE_COVERAGE = (0.012, 0.0)
_TREE_COVERAGE = (0.010, 0.0)
"""Smallest shares of the picture's area of the fine and the coarse level."""


def compose(seed: int) -> dict[str, bytes]:
    """Return the city of a seed: city.glb."""
    return {"city.glb": compose_city(seed).to_bytes()}


def compose_city(seed: int) -> GltfWriter:
    """Return the whole city, not yet written."""
    city = _City(seed)
    city.add_ground()
    city.add_houses()
    city.add_trees()
    city.add_yards()
    city.add_furniture()
    city.add_cars()
    return city.writer


class _City:
    """The file in the making, and the triangles in it so far."""

    def __init__(self, seed: int) -> None:
        self.writer = GltfWriter("mimics_app assets build city")
        self._seed = seed
        self._triangles = 0
        self._materials = add_materials(self.writer, seed, _all_materials())
        self._meshes: dict[str, tuple[int, int]] = {}
        self._parts: dict[tuple[str, str], WrittenPart] = {}

    def _mesh(self, name: str, sketch: Sketch, dyes: dict[str, str] | None = None, shared: str = "") -> None:
        """Make a sketch a mesh; with `shared` its arrays are those of the mesh made first under that name."""
        parts = []
        for material, part in sketch.parts().items():
            key = (shared or name, material)
            if key not in self._parts:
                self._parts[key] = self.writer.add_part(part)
            parts.append((self._parts[key], self._materials[(dyes or {}).get(material, material)]))
        self._meshes[name] = (self.writer.add_mesh(name, parts), sketch.triangle_count)

    def _place(self, parent: int, name: str, placed: Placed, extras: dict[str, Any] | None = None) -> int:
        mesh, triangles = self._meshes[placed.model]
        self._triangles += triangles
        turned, scaled = placed.turn != (0.0, 1.0), placed.scale != (1.0, 1.0, 1.0)
        return self.writer.add_node(
            name,
            parent=parent,
            mesh=mesh,
            translation=placed.place,
            rotation=(0.0, round(placed.turn[0], 6), 0.0, round(placed.turn[1], 6)) if turned else (),
            scale=placed.scale if scaled else (),
            extras=extras,
        )

    def add_ground(self) -> None:
        """Roads, blocks, land, hills and skyline."""
        group = self.writer.add_node("ground")
        sketches: dict[str, Callable[[], Sketch]] = {
            "roads": streets.build_roads,
            "land": landmark.build_land,
            "hills": lambda: landmark.build_hills(self._seed),
            "skyline": lambda: landmark.build_skyline(self._seed),
        }
        for name, make in sketches.items():
            self._mesh(name, make())
            self._place(group, name, Placed(name, (0.0, 0.0, 0.0)))
        blocks = streets.city_blocks()
        for number, block in enumerate(blocks):
            self._mesh(f"block{number}", streets.build_block(block, square=block == layout.square_block(blocks)))
            self._place(group, f"block{number}", Placed(f"block{number}", (0.0, 0.0, 0.0)))

    def add_houses(self) -> None:
        """All rows, each kind in four colours that share their arrays."""
        kinds = draw_kinds(Rng(self._seed, "kinds"))
        houses = {kind.name: build_house(kind) for kind in kinds}
        for number, house in enumerate(houses.values()):
            for colour in range(_COLOURS):
                self._add_colour(house, colour, number)
        group = self.writer.add_node("houses")
        for number, placed in enumerate(layout.lay_houses(kinds, _COLOURS, Rng(self._seed, "rows"))):
            size, centre = houses[placed.model.split("/")[0]].solid
            extras = {"mimics": {"occluder": {"size": list(size), "centre": list(centre)}}}
            node = self._place(group, f"house{number}", placed, extras)
            self.writer.add_detail_levels(node, [self._meshes[f"{placed.model}/coarse"][0]], _HOUSE_COVERAGE)

    def _add_colour(self, house: House, colour: int, first: int) -> None:
        """One colour of a kind; kinds begin at different places of their wall's colours."""
        kind = house.kind
        dye = (colour + first) % len(_PALETTE.walls[kind.wall])
        roof = "slate" if kind.slate else f"tiles{colour}"
        dyes = {"wall": f"{kind.wall}{dye}", "bay": f"{kind.wall}_bay{dye}", "roof": roof}
        self._mesh(f"{kind.name}/{colour}", house.fine, dyes, shared=kind.name)
        self._mesh(f"{kind.name}/{colour}/coarse", house.coarse, dyes, shared=f"{kind.name}/coarse")

    def add_trees(self) -> None:
        """Both sidewalks of every street, and the square."""
        for kind in street_tree.TREES:
            self._mesh(kind.name, street_tree.build_tree(kind, self._seed))
            self._mesh(f"{kind.name}/coarse", street_tree.build_coarse_tree(kind, self._seed))
        self._mesh("church", landmark.build_church())
        self._mesh("bench", furniture.build_bench())
        self._mesh("planter", furniture.build_planter())
        names = [kind.name for kind in street_tree.TREES]
        rng = Rng(self._seed, "trees")
        group = self.writer.add_node("trees")
        for number, placed in enumerate(layout.lay_street_trees(names, rng)):
            self._add_tree(group, f"tree{number}", placed)
        square = self.writer.add_node("square")
        for number, placed in enumerate(layout.lay_square(names, rng)):
            if placed.model in names:
                self._add_tree(square, f"square_tree{number}", placed)
            else:
                self._place(square, f"{placed.model}_{number}", placed)

    def _add_tree(self, group: int, name: str, placed: Placed) -> None:
        node = self._place(group, name, placed)
        self.writer.add_detail_levels(node, [self._meshes[f"{placed.model}/coarse"][0]], _TREE_COVERAGE)

    def add_yards(self) -> None:
        """Behind the houses: workshops, and trees of the coarse form, which nobody comes near."""
        self._mesh("workshop", landmark.build_workshop())
        group = self.writer.add_node("yards")
        names = [kind.name for kind in street_tree.TREES]
        for number, placed in enumerate(layout.lay_yards(names, Rng(self._seed, "yards"))):
            self._place(group, f"yard{number}", placed)

    def add_furniture(self) -> None:
        """Lamps, benches, bins, signs, bollards, tubs."""
        for name, make in (
            ("lamp", furniture.build_lamp),
            ("bin", furniture.build_bin),
            ("bollard", furniture.build_bollard),
            ("sign", furniture.build_sign),
        ):
            self._mesh(name, make())
        group = self.writer.add_node("furniture")
        for number, placed in enumerate(layout.lay_furniture(Rng(self._seed, "street"))):
            self._place(group, f"{placed.model}{number}", placed)

    def add_cars(self) -> None:
        """Add parked cars until the city has its number of triangles."""
        names = []
        for kind in furniture.CARS:
            sketch = furniture.build_car(kind)
            for paint in _PALETTE.paints:
                names.append(f"{kind}/{paint}")
                self._mesh(names[-1], sketch, {"paint": f"paint_{paint}"}, shared=kind)
        group = self.writer.add_node("cars")
        for number, placed in enumerate(layout.lay_cars(names, Rng(self._seed, "cars"))):
            if self._triangles + self._meshes[placed.model][1] > TRIANGLES:
                break
            self._place(group, f"car{number}", placed)


def _all_materials() -> dict[str, Painted]:
    """Every material by the name sketches call it."""
    made = dict(_PALETTE.plain)
    for wall, colours in _PALETTE.walls.items():
        bay = "brick_bay" if wall == "brick" else "plaster_bay"
        for number, colour in enumerate(colours):
            made[f"{wall}{number}"] = Painted(wall, colour)
            made[f"{wall}_bay{number}"] = Painted(bay, colour)
    made |= {f"tiles{number}": Painted("tiles", colour) for number, colour in enumerate(_PALETTE.roofs)}
    return made | {f"paint_{name}": Painted(colour=colour, roughness=0.28) for name, colour in _PALETTE.paints.items()}
