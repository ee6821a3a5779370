"""Trips in the report: plots of the second before each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot
from mimics_app.recording.columns import row_norms
from mimics_app.recording.report_values import Seconds
from mimics_app.recording.run import Run
from mimics_app.recording.trip_log import FOLDER, complete_trips, read_trip

__all__ = ["MOST_DRAWN", "Trip", "trips_of"]

MOST_DRAWN = 8
"""Largest number of trips plotted; the others are in their files."""


@dataclass(frozen=True, slots=True)
class Trip:
    """The second before a trip: time of the trip [s], name of its file, plots ([] without rows)."""

    at_s: Seconds
    file: str
    plots: list[Plot]


def trips_of(run: Run) -> list[Trip]:
    """Return the first trips of a run with their plots."""
    return [_trip(run, tick, path) for tick, path in complete_trips(run)[:MOST_DRAWN]]


def _trip(run: Run, tick: int, path: Path) -> Trip:
    samples = read_trip(path)
    plots = [_forces(samples), _speeds(samples)] if len(samples) > 1 else []
    return Trip(Seconds(run.seconds(tick)), f"{FOLDER}/{path.name}", plots)


def _before(samples: NDArray[Any]) -> NDArray[np.float64]:
    """Return the time relative to the last row [ms], <= 0."""
    return np.asarray(1e3 * (samples["t"] - samples["t"][-1]), np.float64)


def _forces(samples: NDArray[Any]) -> Plot:
    when, rendered = _before(samples), row_norms(samples["f_user_world"])
    wanted, measured = row_norms(samples["f_virt_world"]), row_norms(samples["f_meas"])
    x, y = (
        Axis.of("before the trip [ms]", when, margin=0.0),
        Axis.of("force [N]", rendered, wanted, measured, zero=True),
    )
    plot = Plot(x, y, "Forces before the trip", height=170.0)
    plot.line(when, measured, "measured", "of the person on the handle")
    plot.line(when, wanted, "wall", "virtual")
    plot.line(when, rendered, "rendered", "virtual, as rendered")
    return plot


def _speeds(samples: NDArray[Any]) -> Plot:
    when, speed = _before(samples), row_norms(samples["v_world"])
    step = np.append(0.0, row_norms(np.diff(samples["hip_world"], axis=0)) / np.diff(samples["t"]))
    x, y = Axis.of("before the trip [ms]", when, margin=0.0), Axis.of("speed [m/s]", speed, step, zero=True)
    plot = Plot(x, y, "Speed before the trip", height=150.0)
    plot.line(when, step, "measured", "by the reported positions")
    plot.line(when, speed, "robot", "as reported")
    return plot
