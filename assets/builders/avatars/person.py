"""Description of a person: measures of the body, features of the face, colours, clothes; and all people, of a table."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from assets.builders.kit.palette_texture import Rgb
from mimics_app.contracts.system.table_file import read_table_file

__all__ = ["EVERYBODY", "Body", "Face", "Looks", "Person"]


@dataclass(frozen=True)
class Body:
    """Measures in metres, named as in the table of `measures`; girths are of the relaxed body.

    Attributes:
        woman: Whether the women's half of the table applies.
        stature: Without shoes.
        shoulders: Biacromial breadth.
        upper_arm: Acromion to radiale.
        forearm: Radiale to stylion.
        hand: Length.
        foot: Length.
        neck, chest, waist, hip, thigh, calf, ankle, biceps, wrist: Girths.
        bust: Depth of the breasts.
        belly: Depth of the belly.
    """

    woman: bool
    stature: float
    shoulders: float
    upper_arm: float
    forearm: float
    hand: float
    foot: float
    neck: float
    chest: float
    waist: float
    hip: float
    thigh: float
    calf: float
    ankle: float
    biceps: float
    wrist: float
    bust: float = 0.0
    belly: float = 0.0


@dataclass(frozen=True)
class Face:
    """Differences of a face from the plain one; 1 is plain for sizes, 0 for shifts [mm].

    Attributes:
        breadth, length: Of the head.
        jaw: Breadth of the angle of the jaw.
        chin: Forward [mm].
        cheek: Cheekbones outward [mm].
        brow: Ridge of the brows forward [mm].
        nose: Length, nose_breadth, and bridge forward [mm].
        lips: Fullness.
        mouth: Breadth.
        eyes: Size of the opening.
        slant: Outer corners up [mm].
        full: Cheeks outward [mm].
        age: 0 young to 1 lined.
    """

    breadth: float = 1.0
    length: float = 1.0
    jaw: float = 1.0
    chin: float = 0.0
    cheek: float = 0.0
    brow: float = 0.0
    nose: float = 1.0
    nose_breadth: float = 1.0
    bridge: float = 0.0
    lips: float = 1.0
    mouth: float = 1.0
    eyes: float = 1.0
    slant: float = 0.0
    full: float = 0.0
    age: float = 0.2


@dataclass(frozen=True)
class Looks:
    """Colours, sRGB, and the hair.

    Attributes:
        skin, hair, iris, lips: Colours.
        style: Of the hair: "short", "crop", "bob", "tail" or "curls".
        stubble: Density of the beard, 0 to 1.
        recess: Of the hairline over the temples, 0: round, to 1: far back with a peak in the middle.
    """

    skin: Rgb
    hair: Rgb
    iris: Rgb
    style: str
    lips: Rgb
    stubble: float = 0.0
    recess: float = 0.0


@dataclass(frozen=True)
class Person:
    """A person.

    Attributes:
        name: Name of the file.
        body, face, looks: Measures, features and colours.
        clothes: Names of garments, from `wardrobe`, each with its colour (sRGB).
        years: Age that the person looks.
    """

    name: str
    body: Body
    face: Face
    looks: Looks
    clothes: tuple[tuple[str, Rgb], ...]
    years: int


@dataclass(frozen=True)
class _Dressed:
    """Another person in other clothes, under a name of its own; with other hair and of another age where it has those.

    Attributes:
        name: Name of the file.
        like: Name of the person.
        clothes: As of a `Person`.
        style, hair: As of `Looks`.
        lined: `age` of the `Face`.
        years: As of a `Person`.
    """

    name: str
    like: str
    clothes: tuple[tuple[str, Rgb], ...]
    style: str = ""
    hair: Rgb | None = None
    lined: float | None = None
    years: int = 0

    def of(self, person: Person) -> Person:
        looks = replace(person.looks, style=self.style or person.looks.style, hair=self.hair or person.looks.hair)
        face = person.face if self.lined is None else replace(person.face, age=self.lined)
        years = self.years or person.years
        return replace(person, name=self.name, face=face, looks=looks, clothes=self.clothes, years=years)


@dataclass(frozen=True)
class _Table:
    people: list[Person]
    dressed: list[_Dressed]


def _everybody() -> tuple[Person, ...]:
    table = read_table_file(Path(__file__).with_name("people.json"), _Table)
    known = {person.name: person for person in table.people}
    return (*table.people, *(each.of(known[each.like]) for each in table.dressed))


EVERYBODY = _everybody()
"""All people; the twins wear the same."""
