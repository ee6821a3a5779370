"""A walk from a street onto a narrow beam and over it: where the feet come down, missteps, falls, marks.

Places are distances along the street and the beam and to the right of their middle line [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.tasks.walking.legs import Impairment
from mimics_app.tasks.walking.walker import FootPlace, Walker

__all__ = ["MOST_SWAY", "Beam", "BeamSway", "Crossing", "Wind", "exposure"]

_SHELTER = 12.0
"""Distance from a rim over which the wind rises on the beam [m]."""
_MEAN_PAUSE_S, _GUST_S = 6.0, 2.4
"""Mean time between two gusts, and their duration [s]."""
_STEADY, _STRONGEST = 0.35, 1.0
"""Strength of the steady wind, and of the strongest gust, as shares."""
MOST_SWAY = 0.035
"""Deflection aside in the strongest gust [m]: well seen at the feet, and no reason to fall."""
_SWAY_HZ = 0.45
"""Frequency [Hz]: a beam of wood of this length swings slowly."""
_CREAKS_FROM = 0.4
"""Share of `MOST_SWAY` from which on a turn is heard: beyond the steady wind, which swings it by 0.35."""


def exposure(along: float, begins: float, ends: float) -> float:
    """Return how exposed a place on the beam is: 0 on land, 1 from some metres after a rim on.

    Args:
        along: The place [m].
        begins: The near rim [m].
        ends: The far rim [m].
    """
    inside = min(along - begins, ends - along) / _SHELTER
    share = min(max(inside, 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


class Wind:
    """Gusts from either side.

    Args:
        rng: Source of the gusts.
        calm: No gusts, and half the steady wind.

    Attributes:
        strength: Present strength, 0 to 1.
        push: Present push aside as a share of the strongest, negative to the left.
        side: Side to which the newest gust pushes, -1 left, 1 right; 0 before the first.
    """

    def __init__(self, rng: np.random.Generator, *, calm: bool) -> None:
        self._rng, self._calm = rng, calm
        self._until = float(rng.exponential(_MEAN_PAUSE_S))
        self._since = math.inf
        self.side = self._peak = 0.0
        self.strength = self.push = 0.0

    def blow(self, exposed: float, seconds: float) -> bool:
        """Advance by a time [s] at an exposure (0 to 1); return whether a gust begins."""
        self._since += seconds
        self._until -= seconds
        begins = self._until <= 0.0 and not self._calm
        if begins:
            self._since, self.side = 0.0, float(self._rng.choice((-1.0, 1.0)))
            self._peak = float(self._rng.uniform(0.5, _STRONGEST))
            self._until = _GUST_S + float(self._rng.exponential(_MEAN_PAUSE_S))
        gust = self._peak * math.sin(math.pi * self._since / _GUST_S) ** 2 if self._since < _GUST_S else 0.0
        steady = _STEADY * (0.5 if self._calm else 1.0)
        self.strength = exposed * (steady + (1.0 - _STEADY) * gust)
        self.push = exposed * gust * self.side
        return begins and exposed > 0.0


class BeamSway:
    """Sway of the beam where the person is: as far as the wind is strong; it creaks where it turns back in a gust.

    Attributes:
        aside: Present deflection, to the right [m].
    """

    def __init__(self) -> None:
        self.aside = self._phase = 0.0

    def swing(self, strength: float, seconds: float) -> float:
        """Advance by a time [s] in a wind, 0 to 1; return how loud the beam creaks, 0 to 1."""
        before = self._phase
        self._phase = before + 2.0 * math.pi * _SWAY_HZ * seconds
        self.aside = MOST_SWAY * strength * math.sin(self._phase)
        turns = math.floor(self._phase / math.pi + 0.5) > math.floor(before / math.pi + 0.5)
        return strength if turns and strength > _CREAKS_FROM else 0.0


_LEAN = 0.35
"""Largest speed to the side by leaning [m/s]."""
_PUSH = 0.30
"""Speed to the side in the strongest gust [m/s]."""
_FOOT = 0.045
"""Half the width of a foot [m]."""
_STREET = 2.4
"""Distance from the middle of the street within which somebody stays [m]."""
_FALLS = 0.10
"""Distance of a person's middle beyond the edge of the beam at which they fall [m]."""
_BACK = 1.5
"""How far before the fall they begin again [m]."""
_RESTS_S = 1.6
"""Time of standing after a fall [s]."""


@dataclass(frozen=True, slots=True)
class Beam:
    """The beam.

    Attributes:
        begins, ends: Both rims, along the way [m].
        width: Of its upper side [m].
    """

    begins: float
    ends: float
    width: float

    def carries(self, along: float) -> bool:
        """Whether a place is on the beam and not on land."""
        return self.begins < along < self.ends


class Crossing:
    """One way over the canyon.

    Args:
        beam: The beam.
        impairment: Of the person's legs.
        start: Where the person begins, along the way [m].
        seed: Seed of gusts and feet.
        calm: No gusts.

    Attributes:
        beam: The beam; its width may change.
        walker: The person; the street goes towards -z from z = 0, and right is +x.
        missteps: Feet that came down beyond the edge of the beam.
        on_beam: Feet that came down on or beside the beam.
        falls: Number of falls.
        off: Distances of the feet from the middle of the beam [m].
        marks: Names of places reached since they were last taken: "on_beam", "half_way", "end".
    """

    def __init__(self, beam: Beam, impairment: Impairment, start: float, seed: int, *, calm: bool) -> None:
        self.beam = beam
        self.walker = Walker(impairment, seed)
        self.walker.put(0.0, -start, math.pi)
        self._wind = Wind(np.random.default_rng([seed, 332]), calm=calm)
        self.missteps = self.on_beam = self.falls = 0
        self.off: list[float] = []
        self.marks: list[str] = []
        self._reached: set[str] = set()
        self._rests_s = 0.0
        self._before = start

    @property
    def along(self) -> float:
        """Where the person is along the way [m]."""
        return -self.walker.z

    @property
    def wind(self) -> Wind:
        """The wind where the person is."""
        return self._wind

    @property
    def rests(self) -> bool:
        """Whether the person stands after a fall."""
        return self._rests_s > 0.0

    def step(
        self, speed: float, lean: float | None, seconds: float, legs: LegMotion | None = None
    ) -> tuple[list[FootPlace], list[FootPlace], bool]:
        """Walk for a time.

        Args:
            speed: Wanted speed [m/s].
            lean: Lean to the right, -1 to 1; None: the person is kept in their line, whatever blows.
            seconds: Time step [s].
            legs: Legs in an orthosis, which walk instead; None: the person's own.

        Returns:
            The feet that came down, those of them that missed the beam, and whether a gust begins.
        """
        walker = self.walker
        gust = self._wind.blow(exposure(self.along, self.beam.begins, self.beam.ends), seconds)
        self._rests_s = max(self._rests_s - seconds, 0.0)
        moving = 0.0 if self.rests else min(1.0, walker.speed / 0.2)
        aside = 0.0 if lean is None else moving * (_LEAN * lean + _PUSH * self._wind.push)
        self._before = self.along
        if legs is None:
            feet = walker.step(0.0 if self.rests else speed, 0.0, seconds, (aside, 0.0))
        else:
            legs = legs._replace(belt_speed=0.0) if self.rests else legs
            feet = walker.step_by_legs(legs, 0.0, seconds, (aside, 0.0))
        if not self.beam.carries(self.along):
            walker.x = min(max(walker.x, -_STREET), _STREET)
        missed = [foot for foot in feet if self._misses(foot)]
        self.missteps += len(missed)
        if self.beam.carries(self.along) and abs(walker.x) > 0.5 * self.beam.width + _FALLS:
            self._fall()
        self._mark()
        return feet, missed, gust

    def _misses(self, foot: FootPlace) -> bool:
        """Measure a foot on the beam; return whether its outer edge is beyond the beam's."""
        if not self.beam.carries(-foot.z):
            return False
        self.on_beam += 1
        self.off.append(abs(foot.x))
        return abs(foot.x) + _FOOT > 0.5 * self.beam.width

    def _fall(self) -> None:
        """Set the person back onto the middle of the beam."""
        self.falls += 1
        self._rests_s = _RESTS_S
        back = max(self.along - _BACK, self.beam.begins + 0.5)
        self.walker.put(0.0, -back, math.pi)

    def _mark(self) -> None:
        begins, ends = self.beam.begins, self.beam.ends
        places = {"on_beam": begins, "half_way": 0.5 * (begins + ends), "end": ends}
        for name, place in places.items():
            if name not in self._reached and self._before < place <= self.along:
                self._reached.add(name)
                self.marks.append(name)
