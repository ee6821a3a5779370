"""Figures of the loop: where the R detector fails, and how policies learn. Simulated; no clinical evidence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from mimics_app.contracts.machine import describe_machine
from mimics_app.inputs.physio.simulated.person import LatentPeople, draw_traits
from mimics_app.inputs.physio.simulated.signals import Disturbance, SignalGenerator
from mimics_app.lab.figure import Figure, no_boundary, write_figure
from mimics_app.lab.physio.cohort import play_cohort
from mimics_app.lab.physio.detection import Annotated, mixed_noise, score_beats
from mimics_app.learning.registry import POLICIES
from mimics_app.plotting.drawing import document, legend
from mimics_app.plotting.marks import element, path, word

__all__ = ["draw_figures", "failure_map", "learning_curves"]

_DECIBELS = (np.inf, 12.0, 6.0, 0.0)
_SPOILT = {
    "clean": Disturbance(motion=0.0),
    "10 % ectopic": Disturbance(ectopic=0.1, motion=0.0),
    "wander x 10": Disturbance(wander=0.8, motion=0.0),
    "motion 0.4 m/s": Disturbance(motion=2.0),
    "lead off 20 %": Disturbance(lead_off=0.25, motion=0.0),
}
_SECONDS = 180
_SHOWN = ("random", "staircase", "proportional", "kalman", "thompson", "q")
_WARNING = "Simulated people: what a method does under what was assumed of them. No clinical evidence."
_COMMAND = "mimics bench physio --charts DIR"


def draw_figures(folder: Path) -> list[Path]:
    """Write all figures; the drawings."""
    folder.mkdir(parents=True, exist_ok=True)
    return [write_figure(figure, folder)[1] for figure in (failure_map(), learning_curves())]


def failure_map() -> Figure:
    """F1 of the R detector by what spoils the signal and by added noise."""
    rows, parts = [], []
    left, top, width, height = 130.0, 84.0, 128.0, 46.0
    for j, (name, disturbance) in enumerate(_SPOILT.items()):
        record = _record(disturbance)
        parts.append(word(left + (j + 0.5) * width, top - 12.0, name, "name", "middle"))
        for i, decibel in enumerate(_DECIBELS):
            noisy = record if np.isinf(decibel) else _noisy(record, decibel)
            f1 = score_beats(noisy).f1
            rows.append({"method": name, "x": None if np.isinf(decibel) else decibel, "cost_ns": None, "error": 1 - f1})
            shade, x, y = f"{0.75 * (1.0 - f1) ** 0.5:.3f}", left + j * width, top + i * height
            parts.append(element("rect", class_="dot s1", fill_opacity=shade, x=x, y=y, width=width, height=height))
            parts.append(word(left + (j + 0.5) * width, top + (i + 0.62) * height, f"{f1:.3f}", "strong", "middle"))
    for i, decibel in enumerate(_DECIBELS):
        told = "no noise" if np.isinf(decibel) else f"{decibel:g} dB"
        parts.append(word(left - 12.0, top + (i + 0.62) * height, told, "name", "end"))
    size = (left + len(_SPOILT) * width + 20.0, top + len(_DECIBELS) * height + 60.0)
    return _figure("physio failure map", "F1 of R peaks", size, parts, rows)


def learning_curves(people: int = 400, trials: int = 40) -> Figure:
    """Mean regret by trial with its 95 % band."""
    left, top, width, height, highest = 60.0, 60.0, 760.0, 300.0, 0.9
    parts = [path("frame", f"M{left} {top}v{height}h{width}")]
    rows: list[dict[str, Any]] = []
    for k, name in enumerate(_SHOWN):
        regret = play_cohort(POLICIES[name], n=people, trials=trials).regret
        mean, half = regret.mean(axis=1), 1.96 * regret.std(axis=1) / np.sqrt(people)
        x = left + width * np.arange(trials) / (trials - 1)
        upper, lower = (top + height * (1.0 - np.clip(y, 0.0, highest) / highest) for y in (mean + half, mean - half))
        middle = top + height * (1.0 - np.clip(mean, 0.0, highest) / highest)
        band = _line(x, upper) + _line(x[::-1], lower[::-1]).replace("M", "L", 1) + "Z"
        parts += [
            element("path", class_=f"dot s{k}", d=band, fill_opacity="0.2"),
            path(f"line s{k}", _line(x, middle), name),
        ]
        rows += [{"method": name, "x": t, "cost_ns": None, "error": float(mean[t])} for t in range(trials)]
    for value in (0.0, 0.2, 0.4, 0.6, 0.8):
        y = top + height * (1.0 - value / highest)
        parts += [path("grid", f"M{left} {y:.1f}h{width}"), word(left - 8.0, y + 4.0, f"{value:g}", "small", "end")]
    parts.append(word(left + width / 2.0, top + height + 22.0, "trial, 1 to 40", "small", "middle"))
    parts.append(legend(left, top + height + 44.0, [("line", f"line s{k}", name) for k, name in enumerate(_SHOWN)]))
    size = (left + width + 30.0, top + height + 100.0)
    return _figure("physio learning curves", f"Regret of a trial, {people} people", size, parts, rows)


def _figure(
    name: str, title: str, size: tuple[float, float], parts: list[Markup], rows: list[dict[str, Any]]
) -> Figure:
    machine = str(describe_machine())
    svg = str(document(*size, title, parts, [_WARNING, f"{_COMMAND}   on   {machine}"]))
    whole = [{**row, "valid": True} for row in rows]
    return Figure("figure", name, _COMMAND, machine, whole, [], "", no_boundary(), svg, {"what": title, "unit": "1"})


def _record(disturbance: Disturbance) -> Annotated:
    rng = np.random.default_rng(167)
    people, generator = LatentPeople(draw_traits(rng, 1)), SignalGenerator(rng, disturbance)
    rest = np.array([np.nan]), np.zeros(1), np.zeros(1)
    seconds = []
    for _ in range(_SECONDS):
        people.step(1.0, *rest)
        seconds.append(generator.second(people.drive(np.array([0.4])))["ecg"])
    return Annotated("simulated", 1000.0, np.concatenate(seconds), np.array(generator.truth.beats))


def _noisy(record: Annotated, decibel: float) -> Annotated:
    """The record with noise; where contact was lost there is none."""
    off = np.isnan(record.values)
    filled = Annotated(record.name, record.rate, np.nan_to_num(record.values), record.beats)
    noisy = mixed_noise(filled, decibel, 1)
    return Annotated(noisy.name, noisy.rate, np.where(off, np.nan, noisy.values), noisy.beats)


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> str:
    return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
