"""`mimics render SCENE`: draw frames of a scene to PNG files, without a window."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.arguments import (
    add_display_argument,
    add_profile_argument,
    add_size_argument,
    file_to_write,
    folder_to_write,
    frame_count,
    picture_file,
    random_seed,
    real_number,
    sound_file,
)
from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import counted

if TYPE_CHECKING:
    from mimics_app.app.play.scene_sheet import SceneLight
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["add_arguments", "run"]

_seconds = real_number("time from 0 to 1e6 s", lambda seconds: 0.0 <= seconds < 1e6)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics render`."""
    parser.add_argument(
        "scene", type=Path, help="scene file, or the name of a shipped scene; with --sheet: a folder of scene files"
    )
    parser.add_argument(
        "--backend", choices=("auto", "egl", "osmesa", "window"), default="auto", help="OpenGL context to draw with"
    )
    parser.add_argument(
        "--camera", default="", metavar="ENTITY", help="entity whose camera is used (default: the first camera)"
    )
    parser.add_argument(
        "--frames", type=frame_count, default=1, help="number of frames, spread evenly over --seconds of simulated play"
    )
    parser.add_argument(
        "--seconds",
        type=_seconds,
        default=2.0,
        help="time for which the simulated patient plays, from the first trial on [s]",
    )
    add_size_argument(parser)
    add_display_argument(parser)
    parser.add_argument("--seed", type=random_seed, default=1, help="seed of the simulated patient")
    add_profile_argument(parser)
    parser.add_argument(
        "--video",
        type=file_to_write,
        metavar="FILE",
        help="write a video of --seconds instead of pictures, e.g. out.mp4 (needs ffmpeg)",
    )
    parser.add_argument(
        "--audio",
        type=sound_file,
        metavar="FILE",
        help="write the sound of --seconds instead of pictures, e.g. play.wav",
    )
    parser.add_argument(
        "--sheet",
        type=picture_file,
        metavar="FILE",
        help="draw every scene of a folder on one picture, e.g. scenes.jpg, and print shares of dark and bright pixels",
    )
    parser.add_argument(
        "--output", type=folder_to_write, default=Path("."), metavar="DIR", help="folder of the pictures"
    )


def run(args: argparse.Namespace) -> int:
    """Draw, and print the driver and the files."""
    from mimics_app.app.scenes.scene_search import find_scene
    from mimics_app.app.terminal.first_start import say_if_cold
    from mimics_app.app.terminal.named import check_camera, check_files

    if args.sheet is not None:
        return _lay_out(args)
    find_scene(args.scene)
    check_files(None, args.display)
    from mimics_app.app.scenes.loading import read_scene

    settings = RunSettings(args.scene, seed=args.seed, profile=args.profile, size=args.size, display=args.display)
    read = read_scene(args.scene)
    check_camera(args.camera, read)
    say_if_cold()
    if args.audio is not None:
        return _render_sound(args, settings, read)
    from mimics_app.app.play.stills import draw_stills

    drawn = draw_stills(
        settings,
        args.output,
        backend=args.backend,
        frames=args.frames,
        seconds=args.seconds,
        camera=args.camera,
        video=args.video,
        read=read,
    )
    files = [file.name if args.video is None else str(file) for file in drawn.files]
    lines = [f"{drawn.backend}: {drawn.gl}, {drawn.ms_median:.1f} ms a frame", *map(str, drawn.files)]
    answer(args, {**asdict(drawn), "files": files, "folder": args.output}, lines)
    return 0


def _lay_out(args: argparse.Namespace) -> int:
    """Draw the sheet of a folder, and print the exposure of each scene."""
    from mimics_app.app.play.scene_sheet import draw_scene_sheet, light_rows, scenes_in

    lights = draw_scene_sheet(scenes_in(args.scene), args.sheet, backend=args.backend)
    answer(args, {"files": [args.sheet], "scenes": light_rows(lights)}, [*map(_light_line, lights), str(args.sheet)])
    return 0


def _light_line(light: SceneLight) -> str:
    shade = "-" if light.shade is None else f"{light.shade:.0%}"
    kind = " (night)" if light.night else ""
    return f"{light.scene}: {light.dark:.1%} dark, {light.bright:.1%} bright, shade keeps {shade}{kind}"


def _render_sound(args: argparse.Namespace, settings: RunSettings, read: Scene) -> int:
    """Write the sound of the play."""
    from mimics_app.app.play.scene_sound_file import write_sound

    report = write_sound(settings, args.audio, args.seconds, read)
    what = f"{report.status.mixer} mixer, {report.status.channels} channels, {counted(len(report.rows), 'sounds')}"
    answer(args, {"files": [report.file], **report.summary()}, [what, str(report.file)])
    return 0
