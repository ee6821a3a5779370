"""Signals of a simulated body, fed through the processing in blocks of any size."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.dsp.channel import Channel, Event
from mimics_app.inputs.physio.simulated.person import LatentPeople, draw_traits
from mimics_app.inputs.physio.simulated.signals import SIGNALS, Disturbance, SignalGenerator, Truth

Floats = NDArray[np.float64]


def body(
    seconds: int,
    seed: int = 1,
    disturbance: Disturbance | None = None,
    power: Callable[[int], float] = lambda second: 0.0,
    demand: Callable[[int], float] = lambda second: float("nan"),
) -> tuple[dict[str, Floats], Truth]:
    """Seconds of one person's signals, and what truly happened."""
    rng = np.random.default_rng(seed)
    people = LatentPeople(draw_traits(rng, 1))
    generator = SignalGenerator(rng, disturbance)
    made: dict[str, list[Floats]] = {name: [] for name in SIGNALS}
    for second in range(seconds):
        people.step(1.0, np.array([demand(second)]), np.array([power(second)]), np.ones(1))
        for name, values in generator.second(people.drive(np.zeros(1))).items():
            made[name].append(values)
    return {name: np.concatenate(pieces) for name, pieces in made.items()}, generator.truth


def feed(channel: Channel, values: Floats, block: int) -> list[Event]:
    """All events of a signal, fed in blocks of one size."""
    return [event for i in range(0, len(values), block) for event in channel.push(values[i : i + block])]


def f1(truth: Sequence[float], found: Sequence[float], within: float) -> float:
    """Harmonic mean of sensitivity and precision, events paired one to one in time order."""
    i = j = hits = 0
    truth, found = sorted(truth), sorted(found)
    while i < len(truth) and j < len(found):
        away = found[j] - truth[i]
        if abs(away) <= within:
            hits, i, j = hits + 1, i + 1, j + 1
        elif away < 0:
            j += 1
        else:
            i += 1
    return 2.0 * hits / max(len(truth) + len(found), 1)
