"""Body and adaptation in the report: heart, skin, estimated state and difficulty over the time of the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.feature_names import HEART_RATE, SCL, SCR_RATE
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.report_values import mapping, number, shown
from mimics_app.recording.result_words import trial_names
from mimics_app.recording.run import Run

__all__ = ["Person", "person_of"]

_HEIGHT = 180.0
_NUMBERED = 0.02
"""Shortest trial whose number is written into the plots, as a share of the run."""
_CLASSES = (-1.0, 0.0, 1.0)
"""Under-challenged, challenged and over-challenged on the axis of the load."""

_Lines = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Person:
    """Sources and methods in words, and the plots, all over the same time."""

    words: str
    plots: list[Plot]


def person_of(run: Run) -> Person | None:
    """Return the body signals of a run, the estimated state and the difficulty; None without body signals."""
    features, states, results = (_timed(run, kind) for kind in ("features", "person", "result"))
    heart, level, responses = (_feature(features, name) for name in (HEART_RATE, SCL, SCR_RATE))
    if not any(np.isfinite(values).any() for values in (heart, level)):
        return None
    when = _times(features)
    spans = _spans(run)
    signals = [1e-9 * (row.block.t_ns - run.start_ns) for row in run.signals[-1:]]
    end = max(when.max(), 1.0, *signals, *(end for _, end, _ in spans))
    frame = _Frame(Axis(phrase("time [s]"), 0.0, float(end)), spans, _markers(run))
    plots = (
        frame.signal(phrase("heart rate [1/min]"), when, heart),
        _skin(frame, run, when, level),
        frame.signal(
            phrase("responses [1/min]"), when, responses, phrase("skin conductance responses in the last minute")
        ),
        _load(frame, states),
        _activation(frame, states),
        _difficulty(frame, run, [line for line in results if line.get("outcome") != "step"]),
    )
    return Person(_words(run), [plot for plot in plots if plot is not None])


@dataclass(frozen=True, slots=True)
class _Frame:
    """What all plots share: the time, begin [s], end [s] and name of each trial, and markers: time [s] and name."""

    time: Axis
    trials: list[tuple[float, float, str]]
    markers: list[tuple[float, str]]

    def plot(self, y: Axis) -> Plot:
        """Return a plot with a band for each trial, with its number where there is room, and a line at each marker."""
        plot = Plot(self.time, y, phrase("{what} over time", what=y.label), height=_HEIGHT)
        for begin, end, name in self.trials:
            plot.spans(np.array([begin]), np.array([end]), "driven", phrase("trial"))
            if end - begin >= _NUMBERED * self.time.high:
                plot.word(0.5 * (begin + end), y.high - 0.09 * (y.high - y.low), name if name.isdigit() else name[0])
        for row, (when, name) in enumerate(self.markers):
            plot.mark_x(when, name, row % 2)
        return plot

    def signal(self, label: str, when: F8, values: F8, name: str = "") -> Plot | None:
        """Return the plot of one feature; None where it is known less than twice, so that there is no line."""
        if np.isfinite(values).sum() < 2:
            return None
        plot = self.plot(Axis.of(label, values, margin=0.15))
        plot.line(when, values, "robot", name or label)
        return plot


_SOURCES = {"sim": phrase("a simulated person")}


def _words(run: Run) -> str:
    body, settings = mapping(run.session.get("body")), mapping(run.session.get("settings"))
    source, estimator, policy = settings.get("physio"), body.get("estimator"), body.get("learn")
    sentences = [
        phrase("Body signals from {source}.", source=_SOURCES.get(str(source), source)) if source else "",
        phrase("The load was estimated by {name}.", name=shown(estimator)) if estimator else "",
        phrase(
            "Difficulty was adapted by {name} for {goal}.", name=policy, goal=_goal_in_words(str(body.get("goal", "")))
        )
        if policy
        else "",
    ]
    return " ".join(translated(sentence) for sentence in sentences if sentence)


def _goal_in_words(goal: str) -> str:
    """Return "success of 0.7" for "success:0.7", "arousal from -0.2 to 0.3" for "arousal:-0.2:0.3"."""
    name, *numbers = goal.split(":")
    return " ".join([name, ("", "of", "from")[len(numbers)], " to ".join(numbers)]).strip()


def _spans(run: Run) -> list[tuple[float, float, str]]:
    spans = []
    for row, name in zip(run.trials, trial_names(run.trials), strict=True):
        begin, end = number(row.get("begin_ns")), number(row.get("end_ns"))
        if begin is not None and end is not None:
            spans.append((1e-9 * (begin - run.start_ns), 1e-9 * (end - run.start_ns), name))
    return spans


def _markers(run: Run) -> list[tuple[float, str]]:
    """Return time [s] and name of what a task marks for the body signals, such as "half way" over a canyon."""
    return [(1e-9 * line["t_ns"], str(line.get("name", "")).replace("_", " ")) for line in _timed(run, "marker")]


def _skin(frame: _Frame, run: Run, when: F8, level: F8) -> Plot | None:
    """Plot the recorded skin conductance, in which each response is a peak, and its level."""
    blocks = [row.block for row in run.signals if row.block.name == "gsr" and row.block.rate > 0.0]
    if not blocks:
        return frame.signal(phrase("skin conductance [µS]"), when, level, phrase("level"))
    times = np.concatenate(
        [1e-9 * (block.t_ns - run.start_ns) + np.arange(len(block.values)) / block.rate for block in blocks]
    )
    recorded = np.concatenate([block.values for block in blocks])
    plot = frame.plot(Axis.of(phrase("skin conductance [µS]"), recorded, level, margin=0.15))
    plot.line(*envelope(times, recorded), "measured", phrase("recorded"))
    plot.line(when, level, "robot", phrase("level"))
    return plot


def _load(frame: _Frame, states: _Lines) -> Plot | None:
    """Plot mean and standard deviation of the load under the probabilities of its classes."""
    known, shares = _arrays(states, "load", len(_CLASSES))
    if not len(known):
        return None
    mean = shares @ np.array(_CLASSES)
    spread = np.sqrt(np.maximum(shares @ np.square(_CLASSES) - mean**2, 0.0))
    plot = frame.plot(
        Axis(
            phrase("load"), -1.3, 1.6, at=_CLASSES, words=(phrase("too easy"), phrase("just right"), phrase("too hard"))
        )
    )
    _estimate(plot, known, (mean, spread), "robot", phrase("load as estimated"))
    return plot


def _activation(frame: _Frame, states: _Lines) -> Plot | None:
    """Plot arousal and effort with their standard deviations."""
    plot = frame.plot(Axis(phrase("arousal, effort"), -1.3, 1.6, at=(-1.0, 0.0, 1.0)))
    drawn = False
    for name, kind in ((phrase("arousal"), "robot"), (phrase("effort"), "measured")):
        known, pairs = _arrays(states, name, 2)
        if len(known):
            mean, variance = pairs.T
            _estimate(plot, known, (mean, np.sqrt(np.maximum(variance, 0.0))), kind, name)
            drawn = True
    return plot if drawn else None


def _estimate(plot: Plot, when: F8, estimate: tuple[F8, F8], kind: str, name: str) -> None:
    """Draw mean and standard deviation, clipped to the range of the quantity."""
    mean, spread = estimate
    low, high = np.clip(mean - spread, -1.0, 1.0), np.clip(mean + spread, -1.0, 1.0)
    plot.band(when, low, high, f"spread {kind}", phrase("{name}, ± one standard deviation", name=name))
    plot.line(when, mean, kind, name)


def _difficulty(frame: _Frame, run: Run, results: _Lines) -> Plot | None:
    """Plot difficulty and performance of each trial at its end; None where no parameter makes the task harder."""
    try:
        parameters = msgspec.convert(mapping(run.session.get("body")).get("parameters"), list[Parameter])
    except msgspec.ValidationError:
        return None
    space = ActionSpace(parameters)
    values = [_numbers(line.get("values")) for line in results]
    demands = [space.demand(each) for each in values]
    if not any(demand is not None for demand in demands):
        return None
    when, demand = _times(results), _known(demands)
    plot = frame.plot(Axis(phrase("success, difficulty"), -0.05, 1.25, at=(0.0, 0.5, 1.0)))
    plot.line(
        when, _known([line.get("performance") for line in results]), "measured", phrase("success in the trial, 0 to 1")
    )
    plot.line(when, demand, "robot", phrase("difficulty, 0 easiest to 1 hardest"))
    texts = [", ".join(f"{p.name} {each[p.name]:.3g}" for p in space if p.name in each) for each in values]
    plot.points(when, demand, "contact", phrase("chosen parameters"), texts)
    return plot


def _numbers(item: object) -> dict[str, float]:
    return {name: value for name, each in mapping(item).items() if (value := number(each)) is not None}


def _timed(run: Run, kind: str) -> _Lines:
    """Return the lines of the app with a time, which is counted from the first tick; a damaged one has none."""
    times = [(line, number(line.get("t_ns"))) for line in run.lines_of("app", kind)]
    return [{**line, "t_ns": t_ns - run.start_ns} for line, t_ns in times if t_ns is not None]


def _times(lines: _Lines) -> F8:
    return np.array([1e-9 * line["t_ns"] for line in lines], np.float64)


def _known(values: Sequence[object]) -> F8:
    """Return numbers, NaN where there is none."""
    return np.array([np.nan if (value := number(each)) is None else value for each in values], np.float64)


def _feature(lines: _Lines, name: str) -> F8:
    return _known([mapping(line.get("values")).get(name) for line in lines])


def _arrays(lines: _Lines, name: str, size: int) -> tuple[F8, F8]:
    """Return times [s], shape [n], and values, shape [n, size], of the lines with an array of finite numbers."""
    found = [line for line in lines if isinstance(array := line.get(name), list) and len(array) == size]
    values = np.array([_known(line[name]) for line in found], np.float64).reshape(-1, size)
    finite = np.isfinite(values).all(axis=1)
    return _times(found)[finite], values[finite]
