"""Search for the factors that give a shipped person the measures that were asked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import msgspec
import numpy as np

from mimics_app.contracts.arrays import F8, I8
from mimics_app.world.files.people.body_map import CHAINS, BodyMap
from mimics_app.world.files.people.body_table import GIRTHS, LENGTHS, Body, Sex, read_bodies, tape
from mimics_app.world.files.people.person_model import PersonModel

__all__ = ["Asked", "Fitted", "Reached", "fit_person", "nearest_body"]

_FATNESS = {
    "waist": 1.5, "chest": 1.0, "hip": 1.0, "thigh": 1.1, "calf": 0.9, "ankle": 0.5, "biceps": 1.2, "wrist": 0.4,
    "neck": 0.6,
}  # fmt: skip
"""By how much girths that were not asked change with the mass, the hip's is 1: an assumption, no measurement."""
_NARROWEST, _WIDEST = 0.72, 1.5
"""Bounds of the factor on a girth beyond that of the stature, within which the clothes keep their shape."""
_SHORTEST, _LONGEST = 0.75, 1.33
"""Bounds of the factor on a length beyond that of the stature."""
_CLOSE = 0.01
"""Largest error of a measure that counts as reached."""
_ROUNDS, _HALVINGS = 6, 14
_GREY_FROM, _GREY_TO = 40.0, 85.0
"""Ages between which hair turns grey, on average."""


class Asked(msgspec.Struct, frozen=True):
    """A person.

    Attributes:
        height: Without shoes [m].
        weight: In kilograms.
        age: In years.
        sex: "f" or "m".
        measures: Further ones by the names of `LENGTHS` and `GIRTHS` [m].
    """

    height: float
    weight: float
    age: float
    sex: Sex
    measures: dict[str, float] = {}


class Reached(msgspec.Struct, frozen=True):
    """One measure of the person made.

    Attributes:
        name: Its name; "height" and "weight" among them.
        value: As it came out [m, kg].
        asked: As it was asked; None: derived from height and weight.
        reached: Whether it is within 1 % of that.
    """

    name: str
    value: float
    asked: float | None
    reached: bool


@dataclass(frozen=True)
class Fitted:
    """A person made.

    Attributes:
        like: Name of the shipped person from whom it was made.
        model: Its file.
        measures: What was reached.
    """

    like: str
    model: PersonModel
    measures: tuple[Reached, ...]


def nearest_body(asked: Asked) -> str:
    """Return the name of the shipped person whose build and age are nearest; of equal ones the first."""
    bodies = {name: body for name, body in read_bodies().items() if body.sex == asked.sex}

    def distance(name: str) -> float:
        body = bodies[name]
        build = math.log(asked.weight / asked.height**2) - math.log(body.mass / body.stature**2)
        ratio = asked.height / body.stature
        others = [
            math.log(asked.measures[girth] / (ratio * body.girth(girth))) for girth in GIRTHS if girth in asked.measures
        ]
        return build**2 + sum(value**2 for value in others) + ((asked.age - body.age) / 100.0) ** 2

    return min(bodies, key=distance)


def fit_person(asked: Asked, like: str = "") -> Fitted:
    """Make a person.

    Args:
        asked: What the person measures.
        like: Name of the shipped person whose face and clothes it has; "": the nearest of the same sex.

    Raises:
        KeyError: The shipped person is unknown.
    """
    like = like or nearest_body(asked)
    body = read_bodies()[like]
    search = _Search(asked, body, PersonModel(like))
    body_map = search.run()
    measures = tuple(search.reached(body_map))
    model = search.model
    model.move(body_map)
    grey = max(_grey(asked.age) - _grey(body.age), 0.0) / max(1.0 - _grey(body.age), 0.1)
    model.grow_older(grey, float(np.clip(1.0 + (asked.age - body.age) / 80.0, 0.6, 1.5)))
    return Fitted(like, model, measures)


def _grey(age: float) -> float:
    return float(np.clip((age - _GREY_FROM) / (_GREY_TO - _GREY_FROM), 0.0, 1.0))


class _Search:
    """Search for one person.

    Args:
        asked: What is searched.
        body: The shipped body.
        model: Its file.
    """

    def __init__(self, asked: Asked, body: Body, model: PersonModel) -> None:
        from scipy.spatial import KDTree

        self._asked, self._body, self.model = asked, body, model
        self._ratio = asked.height / body.stature
        self._lengths = _ascending({"stature": asked.height, **{name: self._length(name) for name in LENGTHS}})
        self._places, self._shares = model.surface()
        self._triangles = model.triangles()
        self._volume = _volume(self._places, self._triangles)
        tree = KDTree(self._places)
        self._rings: dict[str, tuple[F8, F8]] = {}
        for name in GIRTHS:
            ring = body.ring(name)
            shares = self._shares[tree.query(ring)[1]]
            if name == "thigh":  # what is nearest may be a skirt, of which both legs have a share
                shares = np.zeros_like(shares)
                shares[:, CHAINS.index("left_leg")] = 1.0
            self._rings[name] = ring, shares

    def run(self) -> BodyMap:
        """Return the map with which girths and weight come out, as far as they can."""
        low, high = -0.6, 0.6
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if self._mass(self._fitted(middle)) < self._asked.weight:
                low = middle
            else:
                high = middle
        return self._fitted(0.5 * (low + high))

    def reached(self, body_map: BodyMap) -> list[Reached]:
        """Return all measures of the person that a map makes."""
        rows = [_reached("height", self._asked.height, self._asked.height)]
        rows.append(_reached("weight", self._mass(body_map), self._asked.weight))
        rows += [_reached(name, self._lengths[name], self._asked.measures.get(name)) for name in LENGTHS]
        rows += [_reached(name, self._girth(body_map, name), self._asked.measures.get(name)) for name in GIRTHS]
        return rows

    def _length(self, name: str) -> float:
        usual = self._ratio * self._body.lengths[name]
        asked = self._asked.measures.get(name, usual)
        return min(max(asked, _SHORTEST * usual), _LONGEST * usual)

    def _fitted(self, fatness: float) -> BodyMap:
        """Return the map with the girths that were asked; the others follow the fatness."""
        asked = self._asked.measures
        factors = {name: self._held(self._ratio * math.exp(fatness * share)) for name, share in _FATNESS.items()}
        for name in GIRTHS:
            if name in asked:
                factors[name] = self._held(asked[name] / self._body.girth(name))
        body_map = self._map(factors)
        for _ in range(_ROUNDS):  # a girth depends a little on its neighbours' factors
            for name in GIRTHS:
                if name in asked:
                    factors[name] = self._held(factors[name] * asked[name] / self._girth(body_map, name))
            body_map = self._map(factors)
        return body_map

    def _held(self, factor: float) -> float:
        return min(max(factor, _NARROWEST * self._ratio), _WIDEST * self._ratio)

    def _map(self, factors: Mapping[str, float]) -> BodyMap:
        return BodyMap(self._body, self.model.joints, self._lengths, dict(factors))

    def _girth(self, body_map: BodyMap, name: str) -> float:
        ring, shares = self._rings[name]
        return tape(body_map.move(ring, shares))

    def _mass(self, body_map: BodyMap) -> float:
        """Return the mass, by the volume with clothes and hair over that of the shipped person."""
        return self._body.mass * _volume(body_map.move(self._places, self._shares), self._triangles) / self._volume


def _ascending(lengths: dict[str, float]) -> dict[str, float]:
    """Return lengths whose heights follow each other as those of a body: the map of heights must not fold."""
    high = lengths["stature"]
    hip = min(max(lengths["hip_height"], 0.40 * high), 0.62 * high)
    knee = min(lengths["knee_height"], 0.75 * hip)
    acromion = min(max(lengths["acromial_height"], hip + 0.15 * high), 0.86 * high)
    return lengths | {"hip_height": hip, "knee_height": knee, "acromial_height": acromion}


def _reached(name: str, value: float, asked: float | None) -> Reached:
    return Reached(name, value, asked, asked is None or abs(value - asked) <= _CLOSE * asked)


def _volume(places: F8, triangles: I8) -> float:
    a, b, c = (places[triangles[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum()) / 6.0
