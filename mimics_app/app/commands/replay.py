"""`mimics replay RUN`: simulate a recorded run again from its inputs, and compare every output, or look at it."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.settings import PICTURE_SIZE
from mimics_app.app.terminal.arguments import add_window_size_argument, file_to_write
from mimics_app.app.terminal.output import answer, say
from mimics_app.contracts.errors import counted

__all__ = ["SPEEDS", "add_arguments", "run"]

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Speeds of `app.replay_view.playhead`, repeated so that --help imports nothing of it (a test compares them)."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics replay`."""
    parser.epilog = (
        "In the window of --view: Space plays or pauses, left and right step by a frame, + and - change the speed, a "
        "click on the bar shows that time, 1 to 9 show the views of the scene; H lists all keys. Marks on the bar are "
        "contacts, begins and ends of trials, notes, and stops. An earlier time is computed from the first frame on. "
        "The sounds of the first run are heard at speed 1."
    )
    parser.add_argument("run_folder", type=Path, metavar="RUN", help="run folder")
    parser.add_argument("--view", action="store_true", help="look at the run in a window instead of comparing it")
    parser.add_argument(
        "--video",
        type=file_to_write,
        metavar="FILE",
        help="draw the run into a film without a window, e.g. run.mp4 (needs ffmpeg)",
    )
    parser.add_argument(
        "--beside", type=Path, metavar="RUN2", help="with --view or --video: a second run, to the right of the first"
    )
    parser.add_argument(
        "--camera",
        default="",
        metavar="ENTITY",
        help="with --view or --video: entity whose camera is used first (default: as the scene says)",
    )
    parser.add_argument(
        "--plain", action="store_true", help="with --view or --video: draw no forces and contacts (F5 in the window)"
    )
    parser.add_argument(
        "--speed",
        type=float,
        choices=SPEEDS,
        default=1.0,
        help="with --view or --video: session time per time of the film, or at first in the window",
    )
    parser.add_argument(
        "--sound", choices=("auto", "off"), default="auto", help="with --view: off: none; auto: sound output (default)"
    )
    parser.add_argument(
        "--scene",
        type=Path,
        metavar="FILE",
        help="with --view or --video: scene file of the run, where it is no longer at its place",
    )
    add_window_size_argument(parser)
    parser.add_argument(
        "--backend", choices=("auto", "egl", "osmesa"), default="auto", help="with --video: OpenGL context to draw with"
    )


def run(args: argparse.Namespace) -> int:
    """Replay and compare: first the haptic loop, then the task on the snapshots of the loop; or show the run.

    Raises:
        PartialDataError: A tick or the task differs, or the run misses ticks, parameters or frames.
        UsageError: An option of the picture is given without one.
        DeviceError: There is no display for a window.
    """
    if args.view or args.video is not None:
        return _show(args)
    _check_without_picture(args)
    return _compare(args)


def _check_without_picture(args: argparse.Namespace) -> None:
    from mimics_app.contracts.errors import UsageError

    given = {
        "--beside": args.beside is not None,
        "--camera": bool(args.camera),
        "--plain": args.plain,
        "--speed": args.speed != 1.0,
        "--scene": args.scene is not None,
        "--size": args.size is not None,
        "--sound": args.sound != "auto",
    }
    named = [name for name, is_given in given.items() if is_given]
    if named:
        raise UsageError(f"{named[0]} needs a picture; without one, replay compares", "add --view or --video FILE")


def _show(args: argparse.Namespace) -> int:
    """Open the window, or draw the film."""
    from mimics_app.app.terminal.display import has_display
    from mimics_app.app.terminal.first_start import say_if_cold
    from mimics_app.contracts.errors import DeviceError, UsageError
    from mimics_app.recording.run import Run

    if args.view and args.video is not None:
        raise UsageError("--view opens a window, --video draws a film without one", "give one of them")
    if args.view and not has_display():
        raise DeviceError("--view needs a display", "without one: --video run.mp4")
    recorded = [Run.open(folder) for folder in (args.run_folder, args.beside) if folder is not None]
    say_if_cold()
    from mimics_app.app.replay_view.replayed_scene import open_replay

    runs = [open_replay(each, args.scene) for each in recorded]
    for replayed in runs:
        for note in replayed.notes:
            say(f"{replayed.run.folder}: {note}")
    shown = {"run_dir": args.run_folder, "frames": [replayed.count for replayed in runs]}
    if args.view:
        from mimics_app.app.replay_view.replay_window import ReplayWindow

        sound, forces = args.sound != "off", not args.plain
        with ReplayWindow(runs, args.size, args.camera, forces=forces, speed=args.speed, sound=sound) as window:
            window.run()
        answer(args, {**shown, "files": []}, [f"{counted(runs[0].count, 'frames')} looked at"])
        return 0
    from mimics_app.app.replay_view.replay_film import draw_replay

    drawn = draw_replay(
        runs,
        args.video,
        args.size or PICTURE_SIZE,
        args.camera,
        forces=not args.plain,
        speed=args.speed,
        backend=args.backend,
    )
    line = f"{drawn.backend}: {drawn.gl}, {drawn.ms_median:.1f} ms a frame"
    answer(args, {**shown, "backend": drawn.backend, "files": drawn.files}, [line, *map(str, drawn.files)])
    return 0


def _compare(args: argparse.Namespace) -> int:
    """Simulate the run again and compare every output."""
    from mimics_app.app.terminal.first_start import say_if_cold
    from mimics_app.recording.run import Run

    recorded = Run.open(args.run_folder)
    say_if_cold()
    from mimics_app.app.session.replay import play_loop, play_task
    from mimics_app.contracts.errors import PartialDataError
    from mimics_app.recording.replay import compare, compare_events, gather

    data, end = gather(recorded), recorded.comparable_end
    replayed = play_loop(recorded, data)
    difference = compare(data.samples, replayed.samples, recorded.layout.uncompared)
    difference = difference or compare_events(recorded.events, replayed.events, end)
    task, task_difference = (None, None) if difference else play_task(recorded, replayed.snapshots)
    if difference or task_difference:
        raise PartialDataError(
            f"{args.run_folder} replays differently: {difference or task_difference}",
            "its inputs were changed, or another version or machine recorded it",
        )
    from mimics_app.app.session.body_replay import replay_body

    body = replay_body(recorded)
    if body is not None and body.difference:
        raise PartialDataError(
            f"{args.run_folder} replays differently: {body.difference}",
            "its signals were changed, or another version or machine recorded it",
        )
    ticks, events = len(data.samples), int((recorded.events["tick"] < end).sum())
    left = len(recorded.events) - events
    counts = {"ticks": ticks, "events": events, "events_not_compared": left, "task": task, "equal": True}
    lines = [
        f"{ticks} ticks replayed, every output and {counted(events, 'events')} equal bit for bit{_left_out(left, end)}"
    ]
    lines.append(_task_line(task))
    if body is not None:
        counts |= {"features": body.features, "states": body.states, "choices": body.choices}
        lines.append(f"{body.features} frames of features, {body.states} states and {body.choices} choices equal")
    answer(args, {"run_dir": args.run_folder, **counts}, lines)
    return 0


def _task_line(task: dict[str, int] | None) -> str:
    """Return what was compared of the task."""
    if task is None:
        return "its task is not compared: the recording does not hold the inputs of the task"
    return f"its task: {counted(task['events'], 'events')} and {counted(task['rows'], 'rows')} of trials.csv equal"


def _left_out(events: int, end: int) -> str:
    """Return what is not compared of a run that was cut off."""
    return f"; the run was cut off: not compared: {counted(events, 'events')} from tick {end} on" if events else ""
