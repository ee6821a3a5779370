"""The body of a simulated person as a source of signals."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.inputs.physio.simulated.kinds import KINDS, Kind
from mimics_app.inputs.physio.simulated.person import Drive
from mimics_app.inputs.physio.simulated.signals import RATE, SIGNALS, Disturbance

__all__ = ["PRESETS", "Preset", "SimulatedBody"]


@dataclass(frozen=True, slots=True)
class Preset:
    """A kind of simulated person.

    Attributes:
        skill: Mean demand that is a challenge, 0 to 1.
        what: Description.
        kind: Heart, skin and breath.
        disturbance: Disturbances of the signals.
    """

    skill: float
    what: str
    kind: Kind = KINDS[0]
    disturbance: Disturbance = field(default_factory=Disturbance)


_WITH_HEART = {kind.heart: kind for kind in KINDS}

_LEGS_PER_ARM = 16.0
"""Mechanical power of two legs that are as busy as an arm, as a multiple of the arm's."""

PRESETS: dict[str, Preset] = {
    "healthy": Preset(0.7, "finds the task easy"),
    "moderate": Preset(0.5, "finds the task just right"),
    "severe": Preset(0.3, "finds the task hard"),
    "blocked": Preset(0.5, "takes a beta blocker", _WITH_HEART["blocked"]),
    "lagged": Preset(0.5, "a heart that follows late", _WITH_HEART["lagged"]),
    "ectopic": Preset(0.5, "5 % early beats", disturbance=Disturbance(ectopic=0.05)),
    "noisy": Preset(0.5, "bad electrodes", disturbance=Disturbance(wander=0.3, muscle=0.12, mains=0.05, motion=0.6)),
    "loose": Preset(0.5, "electrodes that come off", disturbance=Disturbance(lead_off=0.6)),
}


class SimulatedBody(SignalSource):
    """Signals of one simulated person in session time, made second by second.

    Args:
        preset: Name of one of PRESETS.
        seed: Seed of the session.

    Raises:
        KeyError: The preset is unknown.
    """

    def __init__(self, preset: str, seed: int) -> None:
        who = PRESETS[preset]
        person, signals = np.random.default_rng([seed, 1601]).spawn(2)
        self._people = who.kind.people(person, skill=who.skill)
        self._generator = who.kind.signals(signals, who.disturbance)
        self._start_ns: int | None = None
        self._taken = 0
        self._second: dict[str, NDArray[np.float64]] = {}
        self._experiences: list[Experience] = []

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the samples due since the last read."""
        if self._start_ns is None:
            self._start_ns = now_ns
        due = (now_ns - self._start_ns) * RATE // SECOND_NS
        blocks: list[SignalBlock] = []
        while self._taken < due:
            if self._taken % RATE == 0:
                self._second = self._generator.second(self._next_drive())
            begin = self._taken % RATE
            end = min(RATE, begin + due - self._taken)
            t_ns = self._start_ns + self._taken * SECOND_NS // RATE
            blocks += [SignalBlock(name, float(RATE), t_ns, self._second[name][begin:end]) for name in SIGNALS]
            self._taken += end - begin
        return tuple(blocks)

    def take_experience(self, experience: Experience) -> None:
        """Take what the person experienced in a frame."""
        self._experiences.append(experience)

    def close(self) -> None:
        """Nothing is open."""

    def _next_drive(self) -> Drive:
        experiences, self._experiences = self._experiences, []
        demands = [each.demand for each in experiences if each.demand is not None]
        mean = np.array([np.mean(demands)]) if demands else np.array([np.nan])
        power, speed = (np.array([np.mean(each or [0.0])]) for each in _of(experiences))
        acting = np.array([float(bool(experiences) and experiences[-1].acting)])
        self._people.step(1.0, mean, power, acting)
        return self._people.drive(speed)


def _of(experiences: list[Experience]) -> tuple[list[float], list[float]]:
    return [each.power / (_LEGS_PER_ARM if each.legs else 1.0) for each in experiences], [
        each.speed for each in experiences
    ]
