"""Figure of the latency of R peaks: F1 of the beats that are known within a time, by kind of noise."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path

from mimics_app.lab.figure import Figure
from mimics_app.lab.panel import Panel
from mimics_app.lab.physio.detection import NOISE_DB, Annotated, annotated_records, mixed_noise
from mimics_app.lab.physio.noise_study import IN_TIME_S, lag_rows, noisy_records
from mimics_app.lab.physio_drawing import physio_figure, row_of
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import legend

__all__ = ["beat_latency"]

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
