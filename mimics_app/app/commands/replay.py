"""`mimics replay RUN`: simulate a recorded run again from its inputs and compare every output, bit for bit."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mimics_app.contracts.device_descriptor import Kinematics

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics replay`."""
    parser.add_argument("run_folder", type=Path, metavar="RUN", help="run folder")


def run(args: argparse.Namespace) -> int:
    """Replay and compare.

    Raises:
        PartialDataError: a tick comes out differently, or the run misses ticks or parameters.
    """
    from mimics_app.app.terminal import output
    from mimics_app.app.terminal.first_start import say_if_cold
    from mimics_app.recording.run import Run

    recorded = Run.open(args.run_folder)
    say_if_cold()
    from mimics_app.contracts.errors import PartialDataError
    from mimics_app.recording.replay import compare, compare_events, gather
    from mimics_app.rendering.haptic.replay import replay_run

    data = gather(recorded)
    statics = None
    if data.statics is not None:
        from mimics_app.rendering.haptic.object_statics import ObjectStatics

        statics = ObjectStatics.from_arrays(data.statics.arrays, data.statics.fields)
    replayed = replay_run(data.samples, data.blocks, data.rows, statics, kinematics=_kinematics(recorded.session))
    end = recorded.comparable_end
    difference = compare(data.samples, replayed.samples) or compare_events(recorded.events, replayed.events, end)
    if difference is not None:
        raise PartialDataError(
            f"{args.run_folder} replays differently: {difference}",
            "its inputs were changed, or another version or machine recorded it",
        )
    ticks, events = len(data.samples), int((recorded.events["tick"] < end).sum())
    left = len(recorded.events) - events
    if args.json:
        answer = {"ticks": ticks, "events": events, "events_not_compared": left, "equal": True}
        output.write_object("replay", {"run_dir": args.run_folder, **answer})
    else:
        print(f"{ticks} ticks replayed, every output and {events} events equal bit for bit{_left_out(left, end)}")
    return 0


def _kinematics(session: Mapping[str, Any]) -> Kinematics:
    """Of the device that was recorded; runs that name none are of a HapticMaster's kind.

    Raises:
        DeviceError: Its plug-in is not installed here.
    """
    from mimics_app.rendering.haptic.devices.described import descriptor_of
    from mimics_app.rendering.haptic.devices.device_names import SIMULATED

    moved_by = session.get("moved_by")
    name = moved_by.get("kind") or moved_by.get("device") if isinstance(moved_by, dict) else None
    return descriptor_of(str(name or SIMULATED)).kinematics


def _left_out(events: int, end: int) -> str:
    """What is not compared of a run that was cut off."""
    return f"; the run was cut off: its {events} events from tick {end} on are not compared" if events else ""
