"""Page of plots: the newest seconds of every signal with the events found in them, and the features over time."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mimics_app.app.physio.watch import Watch
from mimics_app.contracts.messages.feature_names import BREATH_RATE, HEART_RATE, RMSSD, SCL, SCR_RATE
from mimics_app.dsp.channel_kinds import channel_kind, feature_units
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.page_templates import load_templates
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.run_folder import write_atomically

__all__ = ["write_page"]

_EVENTS = {
    "ecg": ("r_peak", "R peak"),
    "gsr": ("scr", "skin conductance response"),
    "emg": ("emg_onset", "EMG onset"),
    "resp": ("breath", "breath"),
}
"""Kind of the events found in each signal, and its text in the legend."""
_TRENDS = (
    (HEART_RATE, "heart rate"),
    (RMSSD, "RMSSD"),
    (SCL, "skin conductance"),
    (SCR_RATE, "responses"),
    (BREATH_RATE, "breath"),
)
_TEMPLATES = Path(__file__).with_name("templates")
_REFRESH_S = 2


def write_page(watch: Watch, path: Path, title: str, *, live: bool) -> None:
    """Write the page; a live one reloads itself every two seconds."""
    figures = [("Signals", [_signal(watch, name) for name in watch.recent])]
    trends = [plot for name, text in _TRENDS if (plot := _trend(watch, name, text)) is not None]
    figures += [("Features", trends)] if trends else []
    page = load_templates(_TEMPLATES).get_template("physio.html.j2")
    summary = watch.summary()
    text = page.render(title=title, refresh=_REFRESH_S if live else 0, figures=figures, summary=summary)
    write_atomically(path, text.encode())


def _signal(watch: Watch, name: str) -> Plot:
    """Return the plot of the newest seconds of a signal, with a point at each event."""
    times, values = watch.recent_samples(name)
    good = values[np.isfinite(values)]
    low, high = (float(good.min()), float(good.max())) if len(good) else (0.0, 1.0)
    room = 0.08 * (high - low) or 0.5
    kind_of = channel_kind(name)
    y = Axis(f"{name} [{kind_of.unit if kind_of else '1'}]", low - room, high + room)
    plot = Plot(Axis("time [s]", float(times[0]), float(times[-1]) + 1e-3), y, name, height=180.0)
    plot.line(*envelope(times, values), "a", name)
    kind, text = _EVENTS.get(name, ("", ""))
    found = np.array([t for t in watch.times_of(name, kind) if times[0] <= t <= times[-1]])
    if len(found):
        heights = values[np.clip(np.searchsorted(times, found), 0, len(values) - 1)]
        plot.points(found, np.nan_to_num(heights, nan=low), "b", text)
    return plot


def _trend(watch: Watch, name: str, text: str) -> Plot | None:
    pairs = np.array([(row["t_s"], row[name]) for row in watch.features if name in row])
    if len(pairs) < 2:
        return None
    low, high = float(pairs[:, 1].min()), float(pairs[:, 1].max())
    room = 0.1 * (high - low) or 1.0
    label = f"{text} [{feature_units()[name]}]"
    plot = Plot(Axis("time [s]", 0.0, float(pairs[-1, 0])), Axis(label, low - room, high + room), label, height=170.0)
    plot.line(pairs[:, 0], pairs[:, 1], "a")
    return plot
