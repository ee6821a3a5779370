"""What a report shows of each trip: the second before it."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.recording.plot import Axis, Plot
from mimics_app.recording.run import Run
from mimics_app.recording.trip_log import FOLDER, complete_trips, read_trip

__all__ = ["trips_text"]

_MOST_DRAWN = 8


def trips_text(run: Run) -> str:
    """Files and drawings of the trips; "" where there was none.

    Raises:
        OSError: A log that was missing cannot be written.
    """
    trips = complete_trips(run)
    text = "".join(_trip(tick, path) for tick, path in trips[:_MOST_DRAWN])
    if len(trips) > _MOST_DRAWN:
        text += f'<p class="soft">The others stand in {FOLDER}/.</p>'
    return text


def _trip(tick: int, path: Path) -> str:
    samples = read_trip(path)
    name = f"{FOLDER}/{path.name}"
    if len(samples) < 2:
        return f'<p class="soft">{escape(name)}: no row before tick {tick}.</p>'
    return f"<h3>Before the trip at tick {tick}: <code>{escape(name)}</code></h3>{_forces(samples)}{_speeds(samples)}"


def _before(samples: NDArray[Any]) -> NDArray[np.float64]:
    """Time before the last row [ms], <= 0."""
    return np.asarray(1e3 * (samples["t"] - samples["t"][-1]), np.float64)


def _forces(samples: NDArray[Any]) -> str:
    when, felt = _before(samples), _size(samples["f_user_world"])
    wanted, measured = _size(samples["f_virt_world"]), _size(samples["f_meas"])
    x, y = Axis.of("before the trip [ms]", when, margin=0.0), Axis.of("force [N]", felt, wanted, measured, zero=True)
    plot = Plot(x, y, "Forces before the trip", height=170.0)
    plot.line(when, measured, "measured", "of the person on the handle")
    plot.line(when, wanted, "wall", "virtual")
    plot.line(when, felt, "felt", "virtual, as felt")
    return plot.svg()


def _speeds(samples: NDArray[Any]) -> str:
    when, speed = _before(samples), _size(samples["v_world"])
    step = np.append(0.0, _size(np.diff(samples["hip_world"], axis=0)) / np.diff(samples["t"]))
    x, y = Axis.of("before the trip [ms]", when, margin=0.0), Axis.of("speed [m/s]", speed, step, zero=True)
    plot = Plot(x, y, "Speed before the trip", height=150.0)
    plot.line(when, step, "measured", "by the positions told")
    plot.line(when, speed, "robot", "as told")
    return plot.svg()


def _size(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.sqrt(np.sum(vectors * vectors, axis=1)), np.float64)
