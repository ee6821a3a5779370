"""The walk in a gait orthosis in a report: its states over the run, and below them height and force of both feet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.gait_state import GAIT_STATES
from mimics_app.contracts.loop.loop_fields import Extent, contacts_in, point_rows
from mimics_app.contracts.system.phrases import phrase
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.columns import whole

__all__ = ["draw_gait", "gait_spans"]

_UP = 1
"""Component of a position in the world that is its height."""

_MM = 1000.0
_KINDS = ("robot", "measured")
"""Classes of the lines of the left and the right foot in the style sheet."""

_FEET = ("left foot", "right foot")
_HARD = "_f_x"
"""End of the names of the columns with the force of the hard object on each foot."""


def gait_spans(samples: NDArray[Any]) -> list[tuple[str, float, float]]:
    """Return name, begin and end [s] of every state of the walk, in order; [] without one.

    Args:
        samples: Samples of the run, shape [n].
    """
    t, state = samples["t"], whole(samples["gait_state"])
    if len(t) == 0:
        return []
    begins = np.flatnonzero(np.diff(state, prepend=-2))
    ends = [*begins[1:].tolist(), len(t) - 1]
    return [
        (GAIT_STATES[int(state[begin])], float(t[begin]), float(t[end]))
        for begin, end in zip(begins.tolist(), ends, strict=True)
        if 0 <= state[begin] < len(GAIT_STATES)
    ]


def draw_gait(samples: NDArray[Any], extent: Extent) -> list[Plot]:
    """Plot the states of the walk over the run, and the height of the feet and the hard object's force below them.

    Args:
        samples: Samples of the run, shape [n].
        extent: What its device and controller recorded.

    Returns:
        Three plots of one time axis; [] for a run without a walk in a gait orthosis.
    """
    spans = gait_spans(samples) if extent.gait else []
    if not spans:
        return []
    forces = [i for i, (name, _) in enumerate(extent.numbers) if name.endswith(_HARD)]
    obstacle = [samples["numbers"][:, i] for i in forces]
    heights = [_MM * _height(samples, point) for point in range(min(len(_FEET), contacts_in(samples)))]
    t = samples["t"]
    return [
        _draw_states(t, spans),
        _draw_feet(t, spans, phrase("height of the foot [mm]"), heights),
        _draw_feet(t, spans, phrase("force of the obstacle [N]"), obstacle),
    ]


def _height(samples: NDArray[Any], point: int) -> F8:
    height: F8 = point_rows(samples, point)["hip_world"][:, _UP]
    return height


def _draw_states(t: F8, spans: list[tuple[str, float, float]]) -> Plot:
    plot = Plot(
        Axis.of(phrase("time [s]"), t, margin=0.0),
        Axis("", 0.0, 1.0),
        phrase("States of the walk over time"),
        height=110.0,
    )
    for name, begin, end in spans:
        plot.spans(np.array([begin]), np.array([end]), f"gait-{name}", name.replace("_", " "))
    return plot


def _draw_feet(t: F8, spans: list[tuple[str, float, float]], label: str, values: list[F8]) -> Plot:
    """Plot one line for each foot, with a mark where a state begins."""
    lines = [envelope(t, each) for each in values]
    y = Axis.of(label, *[each for _, each in lines], zero=True)
    plot = Plot(Axis.of(phrase("time [s]"), t, margin=0.0), y, phrase("{what} over time", what=label), height=170.0)
    for _, begin, _ in spans:
        plot.mark_x(begin, "")
    for (when, each), kind, foot in zip(lines, _KINDS, _FEET, strict=False):
        plot.line(when, each, kind, foot)
    return plot
