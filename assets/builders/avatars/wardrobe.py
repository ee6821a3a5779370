"""The garments by name, and the bare skin that they leave."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from assets.builders.avatars.cage import ARM_ROWS, LEG_ROWS
from assets.builders.avatars.cloth import Tailor
from assets.builders.avatars.footwear import make_shoes
from assets.builders.avatars.person import Person
from assets.builders.avatars.piece import Piece, joined
from assets.builders.avatars.skeleton import Skeleton
from assets.builders.avatars.skirt import make_skirt

__all__ = ["SLEEVES", "Cover", "cover_of", "dress"]

_WRIST, _ANKLE = len(ARM_ROWS), len(LEG_ROWS)

Sewing = Callable[[Tailor, Person, Skeleton], Piece]


@dataclass(frozen=True)
class Cover:
    """Bare rows of the limbs: arms from the sleeve on, legs between two rows (equal: none)."""

    arm: int
    leg: tuple[int, int]


def _shirt(
    sleeve: int, *, hem: int = 4, neck: int = 19, ease: float = 0.010, hang: float = 0.93, loose: float = 0.014
) -> Sewing:
    def sew(tailor: Tailor, person: Person, bones: Skeleton) -> Piece:
        return tailor.top("top", hem=hem, neck=neck, sleeve=sleeve, ease=ease, hang=hang, loose=loose, drape=0.0016)

    return sew


def _trousers(end: int, *, least: float, ease: float = 0.007, drape: float = 0.0014) -> Sewing:
    def sew(tailor: Tailor, person: Person, bones: Skeleton) -> Piece:
        return tailor.bottom("bottom", waist=6, end=end, ease=ease, least=least, drape=drape)

    return sew


def _skirt(tailor: Tailor, person: Person, bones: Skeleton) -> Piece:
    return make_skirt(tailor, bones, waist=7, end=0.27 * person.body.stature, ease=0.006)


def _socks(tailor: Tailor, person: Person, bones: Skeleton) -> Piece:
    return joined([tailor.sleeve("socks", "legs", side, range(9, _ANKLE + 1), 0.0035) for side in (1, -1)])


def _shoes(tailor: Tailor, person: Person, bones: Skeleton) -> Piece:
    return make_shoes(bones, person.body.foot, person.body.ankle)


_SEWN: Mapping[str, Sewing] = {
    "shirt": _shirt(3, loose=0.006),
    "shirt_long": _shirt(_WRIST, loose=0.008),
    "blouse": _shirt(4, hem=6, neck=18, ease=0.009, loose=0.008),
    "jersey": _shirt(3, hem=3, ease=0.013, hang=0.95, loose=0.008),
    "tunic": _shirt(3, hem=1, ease=0.013, hang=0.97, loose=0.007),
    "trousers": _trousers(_ANKLE, least=0.066),
    "shorts": _trousers(4, least=0.098, ease=0.010, drape=0.0015),
    "skirt": _skirt,
    "socks": _socks,
    "shoes": _shoes,
}
SLEEVES = {"shirt": 3, "shirt_long": _WRIST, "blouse": 4, "jersey": 3, "tunic": 3}
"""Row of the arm where the sleeves of a garment end."""
_BARE_LEGS = {"trousers": (_ANKLE, _ANKLE), "shorts": (3, _ANKLE), "skirt": (3, _ANKLE)}


def dress(tailor: Tailor, person: Person, bones: Skeleton) -> dict[str, Piece]:
    """Return all garments of a person by name."""
    return {name: _SEWN[name](tailor, person, bones) for name, _ in person.clothes}


def cover_of(person: Person) -> Cover:
    """Return the bare rows of a person's limbs."""
    worn = [name for name, _ in person.clothes]
    arm = next(SLEEVES[name] for name in worn if name in SLEEVES)
    leg = next(_BARE_LEGS[name] for name in worn if name in _BARE_LEGS)
    return Cover(arm, (leg[0], 10) if "socks" in worn else leg)
