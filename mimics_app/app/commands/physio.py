"""`mimics physio SOURCE`: read body signals without a scene: plots, features, events, and signal quality."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.terminal.arguments import file_to_write, positive_time, random_seed
from mimics_app.app.terminal.output import answer, say
from mimics_app.contracts.errors import counted

if TYPE_CHECKING:
    from mimics_app.app.physio.watch import Watch
    from mimics_app.contracts.ports.input_port import SignalSource
    from mimics_app.inputs.physio.guarded_source import CheckRate

__all__ = ["add_arguments", "run"]

_CHECK_S = 60.0
_PAGE_EVERY = 100
"""Number of polls of a live source between two pages: two seconds."""
_LEAST_S = 10.0
"""Shortest signal that is evaluated [s]."""
_BAD_SHARE = 0.1
"""Largest acceptable share of bad seconds of a signal."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics physio`."""
    parser.add_argument(
        "source",
        metavar="SOURCE",
        help="file (.csv, .edf, .bdf, .hea), sim:PRESET, lsl:NAME, serial:PORT, board:NAME, or an installed one",
    )
    parser.add_argument(
        "--seconds", type=positive_time, help="time to read [s] (default: the whole file; 60 of other sources)"
    )
    parser.add_argument(
        "--events",
        type=file_to_write,
        metavar="CSV",
        help="write the events found, with the columns t_s,known_s,kind,value,quality",
    )
    parser.add_argument("--features", type=file_to_write, metavar="CSV", help="write the features, one row per second")
    parser.add_argument(
        "--page", type=file_to_write, metavar="HTML", help="write a page of plots; refreshed while a live source runs"
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="check electrodes and connection: exit code 6 where a signal is bad or missing",
    )
    parser.add_argument("--seed", type=random_seed, default=1, help="seed of a simulated person")


def run(args: argparse.Namespace) -> int:
    """Read the source to its end, and print its signals, their quality and the events found."""
    from mimics_app.contracts.errors import PartialDataError

    source, start_s, seconds, live = _open(args)
    from mimics_app.app.physio.watch import Watch

    watch = Watch()
    try:
        _watch(watch, source, args, seconds, live=live)
        if source.lost:
            say(f"body signals are lost: {source.lost}")
    finally:
        source.close()
    if args.events is not None:
        watch.write_events(args.events, start_s)
    if args.features is not None:
        watch.write_features(args.features)
    if args.page is not None and watch.recent:
        _write_page(watch, args, live=False)
    found = watch.summary(source)
    found["notes"] = [*getattr(source, "notes", ())]
    if args.check:
        found["advice"] = _advice(found, source.lost)
    answer(args, found, _lines(found))
    return PartialDataError.exit_code if args.check and found["advice"] else 0


def _open(args: argparse.Namespace) -> tuple[SignalSource, float, float, bool]:
    """Return the source, the time of its first sample [s], the time to read [s], and whether it is live.

    The channels are compiled before a live source is opened, and after a file was found to be right.
    """
    from mimics_app.inputs.physio.sources import find_source, open_file, open_source, source_kinds

    kind, colon, _ = args.source.partition(":")
    misspelt = colon and kind != "file" and not Path(args.source).exists()
    if misspelt or kind in source_kinds() - {"file"}:
        find_source(args.source, say)
        check_rate = _compile()
        return open_source(args.source, args.seed, check_rate), 0.0, args.seconds or _CHECK_S, kind != "sim"
    name = args.source.removeprefix("file:")
    find_source(f"file:{name}", say)
    from mimics_app.dsp.channel_kinds import check_rate

    file = open_file(Path(name), check_rate)
    _compile()
    return file, file.start_s, min(args.seconds or file.seconds, file.seconds), False


def _compile() -> CheckRate:
    """Compile the channels; return the check of a signal's rate."""
    from mimics_app.app.physio.watch import compile_channels
    from mimics_app.dsp.channel_kinds import check_rate

    compile_channels()
    return check_rate


def _watch(watch: Watch, source: SignalSource, args: argparse.Namespace, seconds: float, *, live: bool) -> None:
    from mimics_app.app.physio.watch import blocks_of_file, follow
    from mimics_app.contracts.clock import MonotonicClock

    batches = follow(source, MonotonicClock(), seconds) if live else blocks_of_file(source, seconds)
    for i, (blocks, now_ns) in enumerate(batches):
        watch.take(blocks, now_ns)
        if live and args.page is not None and watch.recent and i % _PAGE_EVERY == _PAGE_EVERY - 1:
            _write_page(watch, args, live=True)


def _write_page(watch: Watch, args: argparse.Namespace, *, live: bool) -> None:
    from mimics_app.app.physio.watch import write_page

    write_page(watch, args.page, f"Body signals: {args.source}", live=live)


def _advice(found: dict[str, Any], lost: str) -> list[str]:
    """Return the corrections to make, one sentence each; `lost` is why the source ended, "" if it did not."""
    if not found["signals"]:
        return ["no signal was received: check that the amplifier sends"]
    advice = [f"{lost}: check its cable and power"] if lost else []
    for name, signal in found["signals"].items():
        if signal["seconds"] < _LEAST_S:
            advice.append(f"{name}: {signal['seconds']:.1f} s are too short: read {_LEAST_S:g} s at least")
        elif signal["bad_share"] > _BAD_SHARE:
            advice.append(f"{name}: {100 * signal['bad_share']:.0f} % of the seconds are bad: check its electrodes")
        faults = signal.get("faults", {})
        if sets := faults.get("clock_sets"):
            advice.append(f"{name}: the sender's clock was set {counted(sets, 'times')}: switch that off")
        if faults.get("wrong_rate"):
            advice.append(f"{name}: its rate is not the {signal['rate']:g} Hz stated: set the amplifier's rate")
        if faults.get("gaps"):
            gaps = f"{counted(faults['lost'], 'samples')} lost in {counted(faults['gaps'], 'gaps')}"
            advice.append(f"{name}: {gaps}: check the connection")
    return advice


_EVENTS = {"r_peak": "heart beats", "scr": "skin responses", "breath": "breaths", "emg_onset": "muscle onsets"}
"""Events in words; others have the name of the column `kind`."""


def _lines(found: dict[str, Any]) -> Iterator[str]:
    from mimics_app.dsp.channel_kinds import feature_units

    for name, signal in found["signals"].items():
        bad = f"{100 * signal['bad_share']:.0f} % bad seconds"
        yield f"{name:6} {signal['seconds']:.1f} s at {signal['rate']:g} Hz, quality {signal['quality']:.2f}, {bad}"
    yield from (f"note   {line}" for line in found["notes"])
    for name, signal in found["signals"].items():
        if dropped := signal.get("faults", {}).get("dropped"):
            yield f"note   {name}: {counted(dropped, 'samples')} left out, as repeating others or without a time"
    events = (counted(n, _EVENTS.get(kind, kind)) for kind, n in found["events"].items())
    yield "found  " + (", ".join(events) or "nothing")
    units = {name: f" {unit}" for name, unit in feature_units().items() if unit != "1"}
    features = {name: value for name, value in found["features"].items() if name != "t_s"}
    last = (f"{name} {value:.4g}{units.get(name, '')}" for name, value in features.items())
    yield "last   " + (", ".join(last) or "nothing")
    if "advice" in found:
        yield from (f"advice {line}" for line in found["advice"] or ["none: all signals are good"])
