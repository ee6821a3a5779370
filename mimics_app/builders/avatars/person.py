"""Description of a person: measures of the body, features of the face, colours, clothes; and all people."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mimics_app.builders.kit.palette_texture import Rgb

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
    """

    name: str
    body: Body
    face: Face
    looks: Looks
    clothes: tuple[tuple[str, Rgb], ...]


_ANNA = Person(
    "woman_anna",
    Body(
        True, 1.66, 0.370, 0.315, 0.242, 0.183, 0.245, 0.318, 0.900, 0.740, 0.975, 0.570, 0.365, 0.215, 0.275, 0.154,
        bust=0.030,
    ),
    Face(breadth=0.97, length=0.97, jaw=0.93, chin=-1.0, cheek=1.0, brow=-2.5, lips=1.15, eyes=1.08, slant=0.8,
         nose=0.93, nose_breadth=0.92, bridge=-0.5, age=0.08),
    Looks((226, 178, 150), (74, 46, 28), (86, 112, 92), "bob", (190, 104, 98)),
    (("shirt_long", (196, 84, 66)), ("trousers", (52, 62, 88)), ("shoes", (92, 64, 46))),
)  # fmt: skip
_MARA = Person(
    "woman_mara",
    Body(
        True, 1.58, 0.358, 0.298, 0.230, 0.175, 0.236, 0.318, 1.000, 0.880, 1.070, 0.640, 0.385, 0.225, 0.315, 0.160,
        bust=0.040, belly=0.012,
    ),
    Face(breadth=1.01, length=0.95, jaw=1.02, chin=-2.0, cheek=2.0, brow=-2.0, lips=1.25, mouth=1.03, eyes=1.02,
         nose=0.95, nose_breadth=1.10, bridge=-2.0, full=3.0, age=0.45),
    Looks((160, 110, 82), (28, 22, 20), (62, 40, 26), "curls", (142, 78, 72), recess=0.4),
    (("blouse", (232, 226, 214)), ("skirt", (70, 92, 84)), ("shoes", (40, 36, 40))),
)  # fmt: skip
_TOM = Person(
    "man_tom",
    Body(
        False, 1.80, 0.420, 0.345, 0.274, 0.197, 0.275, 0.385, 1.000, 0.860, 0.985, 0.585, 0.380, 0.226, 0.325, 0.173,
    ),
    Face(jaw=1.02, brow=0.5, chin=1.0, age=0.15),
    Looks((214, 164, 134), (66, 48, 34), (76, 100, 128), "short", (176, 106, 96), stubble=0.25, recess=0.55),
    (("shirt", (64, 104, 146)), ("trousers", (64, 60, 56)), ("shoes", (66, 62, 60))),
)  # fmt: skip
_OMAR = Person(
    "man_omar",
    Body(
        False, 1.72, 0.410, 0.328, 0.262, 0.190, 0.264, 0.385, 1.110, 1.020, 1.060, 0.635, 0.400, 0.236, 0.360, 0.180,
        belly=0.022,
    ),
    Face(breadth=1.03, length=0.98, jaw=1.08, chin=-0.5, cheek=1.5, brow=1.5, nose=1.06, nose_breadth=1.14, bridge=1.0,
         lips=1.15, mouth=1.05, eyes=0.95, full=2.5, age=0.7),
    Looks((148, 100, 72), (30, 26, 26), (54, 36, 24), "crop", (126, 76, 68), stubble=0.7, recess=0.6),
    (("shirt_long", (92, 112, 84)), ("trousers", (150, 132, 104)), ("shoes", (52, 44, 40))),
)  # fmt: skip

_WHITE, _RED, _BLUE, _TEAL = (232, 232, 228), (176, 40, 42), (40, 60, 128), (70, 146, 148)


def _dressed(person: Person, name: str, *clothes: tuple[str, Rgb]) -> Person:
    return replace(person, name=name, clothes=clothes)


def _combed(person: Person, style: str) -> Person:
    return replace(person, looks=replace(person.looks, style=style))


EVERYBODY = (
    _ANNA,
    _MARA,
    _TOM,
    _OMAR,
    _dressed(_ANNA, "twin_woman", ("shirt", (88, 96, 120)), ("trousers", (70, 74, 82)), ("shoes", (200, 198, 194))),
    _dressed(_TOM, "twin_man", ("shirt", (88, 96, 120)), ("trousers", (70, 74, 82)), ("shoes", (200, 198, 194))),
    _dressed(_TOM, "player_white", ("jersey", _WHITE), ("shorts", _BLUE), ("socks", _WHITE), ("shoes", (36, 36, 38))),
    _dressed(_OMAR, "player_red", ("jersey", _RED), ("shorts", _WHITE), ("socks", _RED), ("shoes", (220, 216, 60))),
    _dressed(
        _combed(_MARA, "tail"), "therapist", ("tunic", _TEAL), ("trousers", (226, 226, 222)), ("shoes", (236, 236, 232))
    ),
)
"""All people; the twins wear the same."""
