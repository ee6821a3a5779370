"""Figures of sound: interaural differences of each mixer around the head, and cost of the voices."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.audio.hearing import BAND_CENTRES, level_differences
from mimics_app.lab.audio.rendered import render_clicks
from mimics_app.lab.audio_bench import find_measured_head
from mimics_app.lab.figure import Figure, write_figure
from mimics_app.lab.groups.spatialiser import measure_block_us
from mimics_app.lab.panel import Panel
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import document, legend
from mimics_app.rendering.audio.settings import AudioSettings
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK
from mimics_app.rendering.audio.spectral.computed_head import compute_head
from mimics_app.rendering.audio.spectral.head import HeadResponses, delays_between_ears
from mimics_app.rendering.audio.spectral.sofa import read_sofa

__all__ = ["draw_figures", "errors_around_the_head"]

Points = list[tuple[float, float]]

_COMMAND = "mimics bench audio --charts DIR"
_RATE = 48_000
_BAND = 4000  # Hz
_LEVEL = 0.02  # of a unit vector: 1 degree about the plane of the ears
_MIXERS: Mapping[str, str] = {"openal": "OpenAL", "spectral": "spectral"}
_VOICES = (1, 4, 16, 64, 128, 192, 256)
_MOST_OPENAL = 200
_BLOCKS = 120
_WIDTH, _HEIGHT = 1000.0, 300.0
_SHOWN = 480  # frames whose cost is shown: 10 ms
_FILE = AudioSettings().block


def draw_figures(folder: Path) -> list[Path]:
    """Write all figures and return the drawings."""
    return [write_figure(figure, folder)[1] for figure in (errors_around_the_head(), _cost_of_voices())]


def errors_around_the_head() -> Figure:
    """Return the figure of interaural delay and level in the horizontal plane: of the head, and of two mixers."""
    path = find_measured_head()
    head = compute_head(0.152) if path is None else read_sofa(path)
    level = np.abs(head.directions[:, 1]) < _LEVEL
    plane = HeadResponses(head.directions[level], head.responses[level], head.rate, head.name)
    azimuth = np.degrees(np.arctan2(plane.directions[:, 0], -plane.directions[:, 2]))
    interaural = {
        f"the head itself: {head.name}": _differences(plane.responses, plane.rate),
        "spectral, given this head": _differences(render_clicks(plane.directions, sofa=path), _RATE),
        "OpenAL, its own head": _differences(render_clicks(plane.directions, "openal"), _RATE),
    }
    order = np.argsort(azimuth)
    delays, levels = (
        {name: list(zip(azimuth[order], pair[k][order], strict=True)) for name, pair in interaural.items()}
        for k in range(2)
    )
    rows = [
        {"method": name, "x": x, "delay_us": delay, "level_db": decibel, "cost_ns": None, "error": None}
        for name in interaural
        for (x, delay), (_, decibel) in zip(delays[name], levels[name], strict=True)
    ]
    x = Axis.around("azimuth to the right [degrees]", azimuth.tolist())
    panels = [
        _panel(0, x, "right ear before the left [us]", delays),
        _panel(1, x, f"right ear over the left at {_BAND // 1000} kHz [dB]", levels),
    ]
    return _figure("hearing around the head", "Delay and level between the ears", panels, list(interaural), rows)


def _cost_of_voices() -> Figure:
    """Return the figure of the cost of 10 ms of moving voices, both mixers, in live blocks and file blocks."""
    measures = {
        f"{label}, {use} ({frames / _RATE * 1e3:.2g} ms)": partial(_cost_us, mixer, frames)
        for mixer, label in _MIXERS.items()
        for use, frames in (("live blocks", LIVE_BLOCK), ("file blocks", _FILE))
    }
    costs: dict[str, Points] = {name: [] for name in measures}
    for voices in _VOICES:
        for name, measure in measures.items():
            if voices <= _MOST_OPENAL or not name.startswith("OpenAL"):
                costs[name].append((float(voices), measure(voices)))
    rows = [{"method": name, "x": x, "cost_ns": 1e3 * cost, "error": None} for name in costs for x, cost in costs[name]]
    every = [cost for points in costs.values() for _, cost in points]
    x = Axis.around("moving voices with head-related filters", [float(n) for n in _VOICES], log=True)
    panel = _panel(0, x, "us for 10 ms of sound", costs, Axis.around("us for 10 ms of sound", every, log=True))
    return _figure("cost of voices", "What voices cost", [panel], list(costs), rows)


def _cost_us(mixer: str, frames: int, voices: int) -> float:
    """Return the cost of the shown time in blocks of `frames` [us]."""
    return _SHOWN / frames * measure_block_us(True, _BLOCKS, voices, mixer, frames)


def _differences(responses: NDArray[np.float64], rate: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return interaural delay [us] and level difference [dB], each of shape [n]."""
    band = BAND_CENTRES.index(_BAND)
    return 1e6 * delays_between_ears(responses, rate), level_differences(responses, rate)[:, band]


def _panel(row: int, x: Axis, label: str, lines: Mapping[str, Points], y: Axis | None = None) -> Panel:
    values = [value for points in lines.values() for _, value in points]
    top = 70.0 + row * (_HEIGHT + 10.0)
    panel = Panel(6.0, top, _WIDTH - 20.0, _HEIGHT, x, y or Axis.around(label, values))
    for k, (name, points) in enumerate(lines.items()):
        panel.line(points, f"line s{k}", name)
        for place, value in points if y is not None else ():
            panel.dot(place, value, f"dot s{k}", f"{name}: {place:g} voices, {value:.3g} us")
    return panel


def _figure(name: str, title: str, panels: list[Panel], names: list[str], rows: list[dict[str, Any]]) -> Figure:
    machine = str(describe_machine())
    entries = [("line", f"line s{k}", each) for k, each in enumerate(names)]
    parts: list[Markup] = [legend(20.0, 52.0, entries), *(panel.svg() for panel in panels)]
    height = 70.0 + len(panels) * (_HEIGHT + 10.0) + 30.0
    svg = str(document(_WIDTH, height, title, parts, [f"{_COMMAND}   on   {machine}"]))
    whole = [{**row, "valid": True} for row in rows]
    return Figure("figure", name, _COMMAND, machine, whole, svg, more={"what": title, "unit": "us"})
