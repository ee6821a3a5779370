"""`mimics replay RUN`: simulate a recorded run again from its inputs and compare every output, bit for bit."""

from __future__ import annotations

import argparse
from pathlib import Path

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
    from mimics_app.recording.replay import compare, gather
    from mimics_app.rendering.haptic.replay import replay_ticks

    data = gather(recorded)
    statics = None
    if data.statics is not None:
        from mimics_app.rendering.haptic.object_statics import ObjectStatics

        statics = ObjectStatics.from_arrays(data.statics.arrays, data.statics.fields)
    difference = compare(data.samples, replay_ticks(data.samples, data.blocks, data.rows, statics))
    if difference is not None:
        raise PartialDataError(
            f"{args.run_folder} replays differently: {difference}",
            "its inputs were changed, or another version or machine recorded it",
        )
    ticks = len(data.samples)
    if args.json:
        output.write_object("replay", {"run_dir": args.run_folder, "ticks": ticks, "equal": True})
    else:
        print(f"{ticks} ticks replayed, every output equal bit for bit")
    return 0
