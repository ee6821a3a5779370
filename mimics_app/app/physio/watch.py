"""Processing of the signals of a source or file as in a session, and its results for pages and tables."""

from __future__ import annotations

import csv
import math
from collections import Counter, deque
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import SECOND_NS, Clock
from mimics_app.contracts.messages.feature_names import BREATH_RATE, HEART_RATE, RMSSD, SCL, SCR_RATE
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.system.whole_file import private_text
from mimics_app.dsp.channel import Event
from mimics_app.dsp.channel_kinds import BUILT_IN, channel_kind, feature_units
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.page_templates import load_templates
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.run_folder import write_atomically

__all__ = ["Watch", "blocks_of_file", "compile_channels", "follow", "write_page"]


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


_SHOWN_S = 12.0
"""Length of the plots of signals [s]."""
_POLL_NS = 20_000_000
"""Period in which a live source is polled [ns]."""
_ANY_RATE = 1000.0
"""Sampling rate that all signals allow [Hz]."""
_BAD = 0.5
"""Quality below which a second counts as bad."""


class Watch:
    """Events, features of every second, and the newest seconds of each signal.

    Attributes:
        events: Events in the order in which they became known, each with the name of its signal.
        features: Features and qualities of each second, by name; `t_s` is the time [s].
        recent: Blocks of the newest seconds of each signal.
        start_ns: Time of the first sample [ns]; -1 before.
    """

    def __init__(self) -> None:
        self._dsp = PhysioDsp(self._note)
        self.events: list[tuple[str, Event]] = []
        self.features: list[dict[str, float]] = []
        self.recent: dict[str, deque[SignalBlock]] = {}
        self.start_ns = -1
        self._offset: dict[str, float] = {}
        self._second = -1
        self._qualities: dict[str, list[float]] = {}

    def take(self, blocks: tuple[SignalBlock, ...], now_ns: int) -> None:
        """Process the blocks received until a time [ns]."""
        for block in blocks:
            if self.start_ns < 0:
                self.start_ns = block.t_ns
            self._offset.setdefault(block.name, (block.t_ns - self.start_ns) / SECOND_NS)
            kept = self.recent.setdefault(block.name, deque())
            kept.append(block)
            while kept[-1].t_ns - kept[0].t_ns > _SHOWN_S * SECOND_NS:
                kept.popleft()
        frame = self._dsp.process(blocks, now_ns)
        second = (frame.t_ns - self.start_ns) // SECOND_NS
        if second != self._second and self.start_ns >= 0:
            self._second = second
            row = {"t_s": (frame.t_ns - self.start_ns) / SECOND_NS, **frame.values}
            row |= {f"quality_{name}": value for name, value in frame.quality.items()}
            self.features.append(row)
            for name, value in frame.quality.items():
                self._qualities.setdefault(name, []).append(value)

    def _note(self, name: str, event: Event) -> None:
        self.events.append((name, event))

    def recent_samples(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return times [s] and values of the newest seconds of a signal."""
        blocks = self.recent[name]
        times = [(b.t_ns - self.start_ns) / SECOND_NS + np.arange(len(b.values)) / b.rate for b in blocks]
        return np.concatenate(times), np.concatenate([b.values for b in blocks])

    def times_of(self, name: str, kind: str) -> list[float]:
        """Return the times of the events of a kind in a signal [s]."""
        return [event.t_s + self._offset[name] for signal, event in self.events if (signal, event.kind) == (name, kind)]

    def summary(self, source: SignalSource | None = None) -> dict[str, Any]:
        """Return rate, length, quality and faults of each signal, counts of events, and the newest features."""
        faults: Mapping[str, Any] = getattr(source, "faults", {})
        signals = {}
        for name, channel in self._dsp.channels.items():
            quality = np.array(self._qualities.get(name, [])[1:] or [channel.found.quality])
            signals[name] = {
                "rate": channel.rate,
                "seconds": channel.seconds,
                "quality": float(np.mean(quality)),
                "bad_share": float(np.mean(quality < _BAD)),
                **({"faults": asdict(faults[name])} if name in faults else {}),
            }
        counts = Counter(event.kind for _, event in self.events)
        newest = {k: v for k, v in (self.features[-1] if self.features else {}).items() if not k.startswith("quality_")}
        return {"signals": signals, "events": counts, "features": newest}

    def write_events(self, path: Path, start_s: float = 0.0) -> None:
        """Write the events as they became known, with the columns t_s, known_s, kind, value, quality.

        Args:
            path: The CSV file.
            start_s: Time of the first sample as stated in its file [s].
        """
        rows = [
            (event.t_s + self._offset[name] + start_s, event.known_s + self._offset[name] + start_s, event)
            for name, event in self.events
        ]
        with private_text(path) as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["t_s", "known_s", "kind", "value", "quality"])
            for t_s, known_s, event in sorted(rows, key=lambda row: row[1]):
                numbers = (f"{t_s:.6f}", f"{known_s:.6f}", event.kind, f"{event.value:.6g}", f"{event.quality:.3f}")
                table.writerow(numbers)

    def write_features(self, path: Path) -> None:
        """Write features and qualities, one row per second; unknown ones are empty."""
        names = sorted({name for row in self.features for name in row} - {"t_s"})
        with private_text(path) as file:
            table = csv.DictWriter(file, ["t_s", *names], lineterminator="\n", restval="")
            table.writeheader()
            table.writerows({name: f"{value:.6g}" for name, value in row.items()} for row in self.features)


def compile_channels() -> None:
    """Compile the processing of every signal: a live source would lose what it sends meanwhile."""
    for name in BUILT_IN:
        if (kind := channel_kind(name)) is not None:
            kind(_ANY_RATE).push(np.zeros(1))


def blocks_of_file(source: SignalSource, seconds: float) -> Iterator[tuple[tuple[SignalBlock, ...], int]]:
    """Yield the blocks of a source that is not live, one second at a time, without waiting."""
    end_ns = math.ceil(seconds * SECOND_NS) + 1  # rounded up, so that the last sample is included
    for now_ns in (*range(0, end_ns, SECOND_NS), end_ns):
        yield source.read(now_ns), now_ns


def follow(source: SignalSource, clock: Clock, seconds: float) -> Iterator[tuple[tuple[SignalBlock, ...], int]]:
    """Yield the blocks of a live source as they arrive."""
    begin = clock.now_ns()
    while (now_ns := clock.now_ns()) - begin < seconds * SECOND_NS:
        yield source.read(now_ns), now_ns
        clock.sleep_until_ns(now_ns + _POLL_NS)
