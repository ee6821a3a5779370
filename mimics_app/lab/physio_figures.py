"""Figures of the physiological loop: detectors, state, policies, and the maps of `physio_maps`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import process_seconds
from mimics_app.estimation.load_people import shipped_people
from mimics_app.lab.figure import Figure, write_figure
from mimics_app.lab.panel import Label, Panel
from mimics_app.lab.physio.cohort import play_cohort
from mimics_app.lab.physio.detection import NOISE_DB, Annotated, annotated_records, detect, f1_of, matched, mixed_noise
from mimics_app.lab.physio.load_sessions import SHIPPED_GAP, draw_load_people
from mimics_app.lab.physio.loop_study import PEOPLE, SEEDS, TRIALS, LoopScore, loop_study, pooled
from mimics_app.lab.physio.noise_study import IN_TIME_S, lag_rows, noisy_records
from mimics_app.lab.physio.state_study import state_study
from mimics_app.lab.physio_drawing import physio_figure, row_of
from mimics_app.lab.physio_maps import failure_map, loop_stability
from mimics_app.learning.registry import POLICIES
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import legend
from mimics_app.plotting.marks import element, path, word

__all__ = ["FIGURES", "detectors", "draw_figures"]


_POLICIES = ("random", "staircase", "kalman_performance", "kalman")
_DRAWN = "drawn as they come"
_CONTROLS: Mapping[str, dict[str, bool]] = {
    "skin does not answer": {"silent": True},
    "body ignores the task": {"blind": True},
}
_CONTROL_PEOPLE = 10
"""Number of people of a control."""
_WHO = (_DRAWN, *_CONTROLS)


def _loop_scores() -> dict[tuple[str, str], list[LoopScore]]:
    """Return the scores of every policy with every kind of people, one for each seed."""
    drawn = {(_DRAWN, name): [loop_study(name, seed=seed) for seed in SEEDS] for name in _POLICIES}
    controls = {
        (who, name): [loop_study(name, _CONTROL_PEOPLE, **more)]
        for who, more in _CONTROLS.items()
        for name in _POLICIES
    }
    return drawn | controls


def loop_regret(groups: Mapping[tuple[str, str], Sequence[LoopScore]] | None = None) -> Figure:
    """Return the figure of the mean regret of a trial with its 95 % interval over the people of all groups.

    Args:
        groups: Result of `_loop_scores`; None: measured now, which takes six minutes of processor time.
    """
    groups = _loop_scores() if groups is None else groups
    scores = {what: pooled(each) for what, each in groups.items()}
    ends = [score.mean + side * score.half_width for score in scores.values() for side in (-1.0, 1.0)]
    y = Axis.around("regret of a trial", [max(value, 0.02) for value in ends], log=True)
    policies = Axis("policy", -0.6, 3.6, at=(0.0, 1.0, 2.0, 3.0), words=_POLICIES)
    panel = Panel(6.0, 70.0, 880.0, 380.0, policies, y)
    rows: list[dict[str, Any]] = []
    for (who, name), score in scores.items():
        k, policy = _WHO.index(who), _POLICIES.index(name)
        x, low, high = policy + 0.2 * (k - 1), max(score.mean - score.half_width, 0.02), score.mean + score.half_width
        panel.line([(x, low), (x, high)], f"line s{k}")
        panel.dot(x, score.mean, f"dot s{k}", f"{name}, {who}: {score.mean:.3f}")
        more = {"half_width": score.half_width, "by_seed": [group.mean for group in groups[who, name]]}
        rows.append(row_of(f"{name}, {who}", float(policy), score.mean) | more)
    parts = [legend(20.0, 52.0, [("line", f"line s{k}", who) for k, who in enumerate(_WHO)]), panel.svg()]
    people = f"{len(SEEDS) * PEOPLE} people of all kinds, {_CONTROL_PEOPLE} of each control"
    what = f"{people}, {TRIALS} trials; kalman goes by success and by the default load estimator"
    return physio_figure("physio loop regret", "What the load is worth to the loop", (900.0, 510.0), parts, rows, what)


_LEFT_OUT = ("noise stress test", "record 118")
"""Kinds of records that are left out: one heart."""


def beat_latency(folder: Path | None) -> Figure:
    """Return the figure of F1 over the time within which a beat must be known; later beats count as missed."""
    rows = list(lag_rows(_simulated() if folder is None else _recorded(folder)))
    x = Axis("known after the R peak [s]", 0.1, 3.2, True)
    panel = Panel(6.0, 90.0, 1060.0, 420.0, x, Axis.around("F1", [max(row.f1, 0.7) for row in rows]))
    panel.line([(IN_TIME_S, panel.y.low), (IN_TIME_S, panel.y.high)], "line dashed")
    kinds = {kind: list(each) for kind, each in groupby(rows, lambda row: row.kind)}
    for k, (kind, each) in enumerate(kinds.items()):
        panel.line([(row.lag_s, max(row.f1, panel.y.low)) for row in each], f"line s{k}", kind)
    entries = [("line", f"line s{k}", kind) for k, kind in enumerate(kinds)]
    rows_of_legend = [legend(20.0, 52.0 + 18.0 * i, entries[4 * i : 4 * i + 4]) for i in range(2)]
    parts = [*rows_of_legend, panel.svg()]
    numbers = [row_of(row.kind, row.lag_s, 1.0 - row.f1) for row in rows]
    what = "One detector; beats that it reports later count as missed. The dashed line is 0.25 s"
    title = "R peaks: F1 of the beats known within a time"
    simulated, size = folder is None, (1080.0, 560.0)
    return physio_figure("physio beat latency", title, size, parts, numbers, what, simulated=simulated)


def _recorded(folder: Path) -> Iterator[tuple[str, Iterable[Annotated]]]:
    return (kind for kind in noisy_records(folder) if not kind[0].startswith(_LEFT_OUT))


def _simulated() -> Iterator[tuple[str, Iterable[Annotated]]]:
    records = list(annotated_records(None))
    yield "records as they are", records
    for decibel in NOISE_DB:
        yield f"synthetic noise, {decibel:g} dB", [mixed_noise(record, decibel, 1) for record in records]


Detector = Callable[[F8, float], F8]

_SHOWN = ("random", "staircase", "proportional", "kalman", "thompson", "q")
_GAPS = (0.08, SHIPPED_GAP, 0.22)
"""Deviation of the demand from the best one in a trial that is too easy or too hard."""
_EACH = 4
"""Number of people of each kind; where the shipped ones were asked the same, these."""
_RIVALS = ("adaptive", "adaptive, not asked", "fixed", "fusion", "success alone", "threshold per person", "majority")
_MINUTES = 5.0
"""Length of a record for the detectors [min]."""


def draw_figures(folder: Path, names: Sequence[str], records: Path | None = None) -> list[Path]:
    """Write figures and return the drawings.

    Args:
        folder: Folder of the files.
        names: Names in `FIGURES`.
        records: Folder of annotated records for the detectors; None: simulated people.
    """
    return [write_figure(FIGURES[name](records), folder)[1] for name in names]


def _load_accuracy() -> Figure:
    """Return the figure of the share of trials estimated right by deviation of the demand, with 95 % intervals."""
    shares = Axis("trials estimated right", 0.0, 1.0, at=(0.0, 0.25, 0.5, 0.75, 1.0))
    panel = Panel(6.0, 70.0, 860.0, 400.0, Axis("demand off the best in a wrong trial", 0.06, 0.25), shares)
    rows: list[dict[str, Any]] = []
    lines: dict[str, list[tuple[float, float]]] = {name: [] for name in _RIVALS}
    for gap in _GAPS:
        people = shipped_people() if gap == SHIPPED_GAP else draw_load_people(_EACH, gap)
        scores = state_study(people)
        for k, name in enumerate(_RIVALS):
            score, x = scores[name], gap + 0.0006 * (k - 3)
            low, high = score.share - score.half_width, min(score.share + score.half_width, 1.0)
            panel.line([(x, low), (x, high)], f"line s{k}")
            panel.dot(x, score.share, f"dot s{k}", f"{name}, {gap:g}: {score.share:.3f}")
            lines[name].append((x, score.share))
            more = {"half_width": score.half_width, "people": len(score.hits)}
            rows.append(row_of(name, gap, 1.0 - score.share) | more)
    for k, name in enumerate(_RIVALS):
        panel.line(lines[name], f"line s{k}", name)
    entries = [("line", f"line s{k}", name) for k, name in enumerate(_RIVALS)]
    parts = [legend(20.0, 52.0, entries), panel.svg()]
    what = f"20 people, 40 at {SHIPPED_GAP:g}, estimated by what was trained on the four other kinds; bars: 95 %"
    return physio_figure(
        "physio load accuracy", "Load of unseen kinds of people by difficulty", (880.0, 530.0), parts, rows, what
    )


def detectors(folder: Path | None) -> Figure:
    """Return the figure of cost against F1 of R peaks in clean, ectopic and noisy records, with installed rivals."""
    kinds = _records(folder)
    rivals: dict[str, Detector] = {"mimics, causal": _ours, **_neurokit_detectors()}
    rows, parts = [], []
    for k, (kind, records) in enumerate(kinds.items()):
        found = {name: _cost_and_f1(find, records) for name, find in rivals.items()}
        x = Axis.around("processor time [s per hour of ECG]", [cost for cost, _ in found.values()], log=True)
        y = Axis.around("F1", [f1 for _, f1 in found.values()])
        panel = Panel(6.0 + 420.0 * k, 60.0, 414.0, 380.0, x, y, kind)
        for name, (cost, f1) in found.items():
            own = name.startswith("mimics")
            panel.dot(cost, f1, "dot s0" if own else "open", f"{name}: F1 {f1:.4f}, {cost:.2g} s per hour")
            panel.label(Label(cost, f1, name.removeprefix("NeuroKit2 "), "name strong" if own else "name"))
            rows.append(row_of(f"{name}, {kind}", cost, 1.0 - f1, cost * 1e9))
        parts.append(panel.svg())
    what = (
        "Open: NeuroKit2's, each over a whole record at once, both ways in time; ours fed in blocks of 20 ms. Records: "
        + ("MIT-BIH 100, 102, 104, 114; 106, 119; noise stress test" if folder else "simulated")
    )
    simulated, size = folder is None, (1272.0, 500.0)
    return physio_figure("physio detectors", "R peaks: cost against F1", size, parts, rows, what, simulated=simulated)


def _records(folder: Path | None) -> dict[str, list[Annotated]]:
    records = list(annotated_records(folder, _MINUTES))
    if folder is None:
        clean, ectopic = records
        return {"clean": [clean], "ectopic": [ectopic], "noisy": [mixed_noise(clean, 6.0, 1)]}
    many = ("mitdb_106", "mitdb_119")
    noisy = [record for record in records if record.name.startswith("nst")]
    ectopic_ones = [record for record in records if record.name in many]
    clean_ones = [record for record in records if record not in noisy and record.name not in many]
    return {"clean": clean_ones, "ectopic": ectopic_ones, "noisy": noisy}


def _ours(values: F8, rate: float) -> F8:
    return np.array([event.t_s for event in detect(values, rate)])


def _cost_and_f1(find: Detector, records: list[Annotated]) -> tuple[float, float]:
    """Return the time per hour of signal [s] and F1 over all beats."""
    spent, seconds, hits, beats, detected = 0.0, 0.0, 0, 0, 0
    for record in records:
        find(record.values[: round(20.0 * record.rate)], record.rate)
        begun = process_seconds()
        found = find(record.values, record.rate)
        spent += process_seconds() - begun
        seconds += len(record.values) / record.rate
        hits += matched(record.beats, found)
        beats += len(record.beats)
        detected += len(found)
    return spent * 3600.0 / seconds, f1_of(hits, beats, detected)


def _learning_curves(people: int = 400, trials: int = 40) -> Figure:
    """Return the figure of the mean regret by trial with its 95 % band."""
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
        rows += [row_of(name, t, float(mean[t])) | {"half_width": float(half[t])} for t in range(trials)]
    for value in (0.0, 0.2, 0.4, 0.6, 0.8):
        y = top + height * (1.0 - value / highest)
        parts += [path("grid", f"M{left} {y:.1f}h{width}"), word(left - 8.0, y + 4.0, f"{value:g}", "small", "end")]
    parts.append(word(left + width / 2.0, top + height + 22.0, f"trial, 1 to {trials}", "small", "middle"))
    parts.append(word(left - 30.0, top - 10.0, "mean regret of a trial, with its 95 % interval", "small", "start"))
    parts.append(legend(left, top + height + 44.0, [("line", f"line s{k}", name) for k, name in enumerate(_SHOWN)]))
    size = (left + width + 30.0, top + height + 116.0)
    return physio_figure("physio learning curves", f"Regret of a trial, {people} people", size, parts, rows)


def _line(x: F8, y: F8) -> str:
    return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))


_METHODS = ("neurokit", "pantompkins1985", "hamilton2002", "elgendi2010", "engzeemod2012")


def _neurokit_detectors() -> dict[str, Callable[[F8, float], F8]]:
    """Return detectors of R peaks [s] in an ECG [mV] at a rate [Hz], by name; none without NeuroKit2."""
    try:
        import neurokit2
    except ImportError:
        return {}

    def detector(method: str) -> Callable[[F8, float], F8]:
        def find(values: F8, rate: float) -> F8:
            whole = round(rate)
            cleaned = neurokit2.ecg_clean(values, sampling_rate=whole, method=method)
            _, found = neurokit2.ecg_peaks(cleaned, sampling_rate=whole, method=method)
            return np.asarray(found["ECG_R_Peaks"], float) / rate

        return find

    return {f"NeuroKit2 {method}": detector(method) for method in _METHODS}


FIGURES: Mapping[str, Callable[[Path | None], Figure]] = {
    "detectors": detectors,
    "beat_latency": beat_latency,
    "failure_map": lambda _: failure_map(),
    "loop_stability": lambda _: loop_stability(),
    "learning_curves": lambda _: _learning_curves(),
    "load_accuracy": lambda _: _load_accuracy(),
    "loop_regret": lambda _: loop_regret(),
}
"""Function of a folder of annotated records, None for simulated people, that returns a figure, by name."""
