"""`mimics warmup`: compile the kernels now, so that the first run starts at once."""

from __future__ import annotations

import argparse
import sys

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics warmup`: none."""


def run(args: argparse.Namespace) -> int:
    """Compile every kernel of a run that is not in the cache yet."""
    from mimics_app.app.terminal import output
    from mimics_app.contracts.clock import MonotonicClock
    from mimics_app.contracts.kernel import cache_folder

    clock = MonotonicClock()
    started = clock.now_ns()
    if not args.json:
        sys.stderr.write("compiling kernels ...\n")
    _compile_everything()
    seconds = (clock.now_ns() - started) * 1e-9
    folder = str(cache_folder) if cache_folder else ""
    if args.json:
        output.write_object("warmup", {"seconds": seconds, "cache": folder})
    else:
        sys.stderr.write(f"kernels ready in {seconds:.1f} s, kept in {folder or 'memory only'}\n")
    return 0


def _compile_everything() -> None:
    """Run a short session in memory: loop, devices, world."""
    from pathlib import Path

    from mimics_app.app.scenes.loading import load_checked_scene
    from mimics_app.app.touch.rehearsal import rehearse

    rehearse(load_checked_scene(Path("scenes/wavy_tunnel.json")), ticks=100)
