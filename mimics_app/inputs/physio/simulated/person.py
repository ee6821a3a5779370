"""Latent state of simulated people: skill, arousal, valence, effort and fatigue under a task, vectorised over people.

The result is a `Drive`, the slow quantities that the body signals follow; `simulated.signals` synthesises the signals
and shares no constant with this module. A closed loop with such a person shows that a method works under these
assumptions. It is not clinical evidence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["Drive", "Family", "LatentPeople", "Skin", "Traits", "draw_traits"]

Family = Literal["linear", "saturating", "lagged", "blocked", "flipped"]
"""Response of the heart rate to arousal: proportional; saturating; delayed; damped (beta blocker); inverted."""

Skin = Literal["rate", "level", "amplitude"]
"""What of the skin shows arousal most: the number of responses, the level between them, or their amplitude."""
_BY_SKIN: Mapping[Skin, tuple[float, float, float]] = {
    "rate": (1.0, 0.15, 0.0),
    "level": (0.4, 0.3, 0.2),
    "amplitude": (0.5, 0.12, 1.0),
}
"""Share of the further responses, and rises of level and amplitude from rest to full arousal as shares of rest: the
three go together in some people and not in others (Boucsein, Electrodermal Activity, 2012)."""

_NON_RESPONDERS = 0.12
"""Share of people whose body does not show arousal; 10-15 % do not respond electrodermally (Dawson, Schell & Filion,
Handbook of Psychophysiology, 2007)."""
_AROUSAL_S = 8.0
"""Time constant of arousal itself [s]."""
_EFFORT_ON_S, _EFFORT_OFF_S = 35.0, 50.0
"""Time constants of the heart rate at the onset and the end of work [s]: 30-60, recovery slower (Linnarsson, Acta
Physiol Scand Suppl 415, 1974)."""
_SLOPE = 5.0
"""Slope of the arousal aimed at, tanh(slope * (demand - skill))."""
_TIRED = 0.2
"""Loss of skill at full fatigue [demand]."""
_FULL_POWER = 1.5
"""Mechanical power of an arm on a light robot that counts as full effort [W]."""


@dataclass(frozen=True, slots=True)
class Traits:
    """Individual parameters of people, each of shape [n].

    Attributes:
        skill: Demand at which the task is a challenge, 0 to 1.
        learning: Skill gained per minute of being challenged.
        heart_rest: [1/min]; 60 to 90 at rest (Nunan, Sandercock & Brodie, PACE 33, 2010).
        heart_arousal: Rise from rest to full arousal [1/min]; mental stress 5 to 20 (Kirschbaum et al., 1993).
        heart_effort: Rise at full effort [1/min].
        variability: RMSSD at rest [ms]; 20 to 60 (Nunan et al., 2010).
        breath_rest: [1/min]; 12 to 20.
        conductance: Tonic level [uS]; 2 to 20 (Boucsein, Electrodermal Activity, 2012).
        responses: SCRs per minute at rest; 1 to 3 (Dawson et al., 2007).
        more_responses: Further ones at full arousal; up to 20 in all.
        level_rise: Rise of the tonic level at full arousal, as a share of it.
        response: Amplitude [uS]; 0.1 to 1.
        response_rise: Rise of the amplitude at full arousal, as a share of it.
        delay_s: From arousal to heart [s], beyond its own time constant.
        habituation: Share of the amplitude left after ten minutes.
    """

    skill: F8
    learning: F8
    heart_rest: F8
    heart_arousal: F8
    heart_effort: F8
    variability: F8
    breath_rest: F8
    conductance: F8
    responses: F8
    more_responses: F8
    level_rise: F8
    response: F8
    response_rise: F8
    delay_s: F8
    habituation: F8


def draw_traits(
    rng: np.random.Generator, n: int, family: Family = "linear", skill: float = 0.5, skin: Skin = "rate"
) -> Traits:
    """Draw people of a family and a skin around a mean skill; about one in eight is a non-responder."""

    def normal(mean: float, deviation: float, low: float, high: float) -> F8:
        return np.clip(rng.normal(mean, deviation, n), low, high)

    responds = (rng.random(n) >= _NON_RESPONDERS).astype(float)
    share, level, amplitude = _BY_SKIN[skin]
    heart = responds * normal(12.0, 4.0, 5.0, 20.0)
    if family == "blocked":
        heart *= 0.3
    if family == "flipped":
        heart *= -1.0
    return Traits(
        skill=normal(skill, 0.1, 0.05, 0.95),
        learning=rng.uniform(0.0, 0.008, n),
        heart_rest=normal(72.0, 8.0, 55.0, 95.0),
        heart_arousal=heart,
        heart_effort=normal(16.0, 5.0, 6.0, 30.0),
        variability=normal(38.0, 10.0, 18.0, 65.0),
        breath_rest=normal(15.0, 2.0, 11.0, 20.0),
        conductance=normal(7.0, 3.0, 2.0, 18.0),
        responses=normal(2.0, 0.7, 0.5, 4.0),
        more_responses=responds * share * normal(10.0, 3.0, 4.0, 16.0),
        level_rise=responds * level,
        response=normal(0.35, 0.12, 0.1, 0.9),
        response_rise=responds * amplitude,
        delay_s=rng.uniform(10.0, 30.0, n) if family == "lagged" else rng.uniform(0.0, 4.0, n),
        habituation=rng.uniform(0.5, 0.9, n),
    )


@dataclass(frozen=True, slots=True)
class Drive:
    """Slow quantities that drive the signals for one second, each of shape [n].

    Attributes:
        heart_rate: Mean [1/min].
        variability: RMSSD [ms].
        breath_rate: [1/min]
        breath_depth: 1 at rest.
        conductance: Tonic [uS].
        responses: Expected SCRs per minute.
        response: Their amplitude [uS].
        muscle: Activity, 0 to 1.
        fatigue: Of the muscle, 0 to 1.
        motion: Speed of the hand [m/s], which causes motion artefacts.
    """

    heart_rate: F8
    variability: F8
    breath_rate: F8
    breath_depth: F8
    conductance: F8
    responses: F8
    response: F8
    muscle: F8
    fatigue: F8
    motion: F8

    def one(self, i: int) -> Drive:
        """Return the drive of one person, as arrays of shape [1]."""
        return Drive(*(getattr(self, each.name)[i : i + 1] for each in fields(self)))


class LatentPeople:
    """The latent state of people through a session.

    Args:
        traits: Individual parameters, shape [n].
        family: Response of their heart rate to arousal.

    Attributes:
        skill, arousal, valence, effort, fatigue: Present state, shape [n]; for a scorer, never for an estimator.
    """

    def __init__(self, traits: Traits, family: Family = "linear") -> None:
        self.traits = traits
        self._family = family
        n = len(traits.skill)
        self.skill = traits.skill.copy()
        self.arousal, self.valence, self.effort, self.fatigue = (np.zeros(n) for _ in range(4))
        self._in_heart = np.zeros(n)
        self._seconds = 0.0

    @property
    def best(self) -> F8:
        """Demand at which the task is a challenge now: the skill, less what fatigue takes of it, shape [n]."""
        return np.asarray(self.skill - _TIRED * self.fatigue)

    def gap(self, demand: F8) -> F8:
        """Return how far a demand lies above the best one, shape [n]."""
        return np.asarray(demand - self.skill + _TIRED * self.fatigue)

    def step(self, seconds: float, demand: F8, power: F8, acting: F8) -> None:
        """Advance the state.

        Args:
            seconds: Step [s], at most a few: inputs are constant over it.
            demand: Demand of the task, 0 to 1, shape [n]; NaN at rest.
            power: Mechanical power [W], shape [n].
            acting: Whether the person may act, 0 or 1, shape [n].
        """
        asked = np.isfinite(demand) & (acting > 0.0)
        gap = np.where(asked, self.gap(np.nan_to_num(demand)), 0.0)
        aim = np.where(asked, np.tanh(_SLOPE * gap), 0.0)
        self.arousal += _share(seconds, _AROUSAL_S) * (aim - self.arousal)
        pleasure = np.where(asked, 1.0 - (gap / 0.25) ** 2, 0.2)
        self.valence += _share(seconds, 20.0) * (np.clip(pleasure, -1.0, 1.0) - self.valence)
        work = np.clip(power / _FULL_POWER, 0.0, 1.5)
        slow = np.where(work > self.effort, _EFFORT_ON_S, _EFFORT_OFF_S)
        self.effort += -np.expm1(-seconds / slow) * (work - self.effort)
        self.fatigue = np.clip(self.fatigue + seconds * (work / 1200.0 - (1.0 - acting) / 900.0), 0.0, 1.0)
        self.skill += self.traits.learning * seconds / 60.0 * np.where(asked, np.exp(-((gap / 0.15) ** 2)), 0.0)
        self._in_heart += -np.expm1(-seconds / (4.0 + self.traits.delay_s)) * (self.arousal - self._in_heart)
        self._seconds += seconds

    def drive(self, motion: F8) -> Drive:
        """Return the present drive; `motion` is the speed of the hand [m/s], shape [n]."""
        traits, excited = self.traits, np.clip(self.arousal, 0.0, 1.0)
        arousal = self._in_heart
        if self._family == "saturating":
            arousal = np.tanh(2.5 * arousal) / np.tanh(2.5)
        quiet = 1.0 - 0.45 * np.clip(arousal, -0.3, 1.0) - 0.35 * np.clip(self.effort, 0.0, 1.0)
        heart = traits.heart_rest + traits.heart_arousal * arousal + traits.heart_effort * self.effort
        worn = traits.habituation ** (self._seconds / 600.0)
        responding = traits.more_responses > 0.0
        return Drive(
            heart_rate=np.clip(heart, 40.0, 190.0),
            variability=traits.variability * np.clip(quiet, 0.15, 1.3),
            breath_rate=traits.breath_rest * (1.0 + np.where(responding, 0.2, 0.0) * arousal + 0.35 * self.effort),
            breath_depth=1.0 + 0.5 * self.effort - 0.15 * excited,
            conductance=traits.conductance * (1.0 + traits.level_rise * self.arousal),
            responses=np.maximum(traits.responses + traits.more_responses * self.arousal, 0.2),
            response=traits.response * worn * np.maximum(1.0 + traits.response_rise * self.arousal, 0.2),
            muscle=np.clip(self.effort, 0.0, 1.0),
            fatigue=self.fatigue,
            motion=motion,
        )


def _share(seconds: float, time_constant: float) -> float:
    return float(-np.expm1(-seconds / time_constant))
