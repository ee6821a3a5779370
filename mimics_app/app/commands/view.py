"""`mimics view FILE`: look at a model or a scene from all sides, move objects, see the work of the renderer."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.settings import PICTURE_SIZE
from mimics_app.app.terminal.arguments import (
    add_profile_argument,
    add_window_size_argument,
    file_to_write,
    frame_count,
    picture_file,
)
from mimics_app.app.terminal.named import check_file
from mimics_app.app.terminal.output import answer, errors_of, issue_lines
from mimics_app.contracts.errors import DeviceError, SceneError, UsageError

if TYPE_CHECKING:
    from mimics_app.app.viewer.shown import Shown

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics view`."""
    parser.epilog = (
        "In the window: drag to orbit, wheel to zoom, WASD to fly, click to select an object, drag it to move it, "
        "Tab to edit a scene (entities, their values, add, delete, play), Ctrl+Z to undo, Ctrl+S to save; H lists all "
        "keys. Files and shaders reload when they change."
    )
    parser.add_argument(
        "file", type=Path, nargs="?", help="scene, model (.glb, .gltf, .vrm) or mesh (.stl, .obj, .ply, .off)"
    )
    parser.add_argument("--edit", action="store_true", help="open the panels of the editor of a scene at once")
    parser.add_argument("--sheet", type=Path, metavar="FOLDER", help="draw every model of a folder onto one PNG")
    parser.add_argument("--headless", action="store_true", help="no window: draw PNG files, to view.png or --output")
    parser.add_argument(
        "--output", type=picture_file, metavar="PNG", help="file to draw to, without a window (default: view.png)"
    )
    parser.add_argument(
        "--frames",
        type=frame_count,
        default=1,
        help="with --headless: number of pictures, spread over one turn of the camera",
    )
    parser.add_argument(
        "--video",
        type=file_to_write,
        metavar="FILE",
        help="with --headless: write a video of the turn, e.g. out.mp4 (needs ffmpeg)",
    )
    parser.add_argument("--caption", action="store_true", help="with --headless: write name and notes into the picture")
    add_window_size_argument(parser)
    parser.add_argument("--clip", default="", metavar="NAME", help="animation clip that the model plays")
    parser.add_argument(
        "--motion",
        type=Path,
        metavar="FILE",
        help="recorded motion (.bvh, .c3d) that the model of a person plays as a clip",
    )
    parser.add_argument("--at", type=float, metavar="S", help="show the clip held at this time [s]")
    parser.add_argument(
        "--vertices",
        type=file_to_write,
        metavar="NPZ",
        help="write all vertices, in the world after morphs and skins",
    )
    parser.add_argument("--up", choices=("y", "z"), default="y", help="upward axis of a mesh file")
    parser.add_argument(
        "--camera",
        default="",
        metavar="ENTITY",
        help="entity whose camera is used first (default: the scene's first camera, or a view of everything)",
    )
    add_profile_argument(parser, "quality of the picture of a scene: draft is cheapest, study best")
    parser.add_argument(
        "--backend",
        choices=("auto", "egl", "osmesa"),
        default="auto",
        help="with --headless: OpenGL context to draw with",
    )


def run(args: argparse.Namespace) -> int:
    """Show or draw; exit code 3 when models of a folder are missing on its sheet, each reported with its reason.

    Raises:
        UsageError: Neither a file nor a folder is given, or both.
        SceneError: The file is missing, of an unknown kind, or faulty.
        DeviceError: There is no display for a window.
    """
    if (args.file is None) == (args.sheet is None):
        raise UsageError("give either a file to look at or --sheet FOLDER", "see mimics view --help")
    _check_clip(args)
    headless = args.headless or args.output is not None
    if (args.frames > 1 or args.video is not None) and not headless:
        raise UsageError("--frames and --video need --headless", "add --output turn.png")
    from mimics_app.app.scenes.scene_search import find_file, find_scene

    if args.sheet is not None:
        args.sheet = find_file(args.sheet)
        args.output = args.output or Path("view.png")
        return _draw_sheet(args)
    if args.file.suffix.lower() in (".json", ""):
        find_scene(args.file)
        _check_camera(args)
    else:
        args.file = find_file(args.file)
        check_file(args.file)
    if args.motion is not None:
        check_file(args.motion)
    from mimics_app.app.terminal.display import has_display

    if not (headless or args.vertices is not None or has_display()):
        raise DeviceError("the viewer needs a display", "without one: add --output picture.png")
    from mimics_app.app.viewer.shown import open_shown

    shown = open_shown(args.file, args.up, faulty=args.edit)
    if args.motion is not None:
        from mimics_app.app.viewer.playing import add_motion

        add_motion(shown, args.motion)
        args.clip = args.clip or args.motion.stem
    if args.clip:
        from mimics_app.app.viewer.playing import play_clip

        play_clip(shown, args.clip, args.at or 0.0, speed=1.0 if args.at is None else 0.0)
    if args.vertices is not None and args.output is None and not args.headless:
        return _write(args, shown)
    return _draw(args, shown) if headless else _open_window(args, shown)


def _check_camera(args: argparse.Namespace) -> None:
    """Refuse a camera that the scene does not have."""
    if args.camera:
        from mimics_app.app.scenes.loading import read_scene
        from mimics_app.app.terminal.named import check_camera

        check_camera(args.camera, read_scene(args.file))


def _check_clip(args: argparse.Namespace) -> None:
    """Refuse a time without a clip, a negative or infinite one, and clips of a sheet."""
    if args.at is not None and not (args.clip or args.motion):
        raise UsageError("--at is the time within a clip", "name the clip with --clip NAME")
    if args.at is not None and not 0.0 <= args.at < float("inf"):
        raise UsageError(f"invalid time within a clip: --at {args.at:g}", "give seconds, 0 or more")
    if args.sheet is not None and (args.clip or args.motion or args.vertices is not None):
        raise UsageError("--clip, --motion and --vertices need one file", "name it instead of --sheet")


def _write(args: argparse.Namespace, shown: Shown) -> int:
    """Write the vertices and draw nothing."""
    from mimics_app.app.viewer.playing import write_vertices

    count = write_vertices(shown, args.vertices)
    found = {**_describe(shown), "vertices": count, "files": [str(args.vertices)]}
    answer(args, found, _lines(found))
    return 0


def _open_window(args: argparse.Namespace, shown: Shown) -> int:
    from mimics_app.app.viewer.viewer_window import ViewerSession

    with ViewerSession(shown, args.size, args.profile, args.camera, args.up, edit=args.edit) as session:
        session.run()
        saved, pictures, backend = session.saved, session.pictures, session.backend
    found = {**_describe(shown), "backend": backend, "files": pictures, "saved": saved}
    answer(args, found, _lines(found))
    return 0


def _draw(args: argparse.Namespace, shown: Shown) -> int:
    from mimics_app.app.viewer.stills import draw_turntable

    files = []
    if args.vertices is not None:
        from mimics_app.app.viewer.playing import write_vertices

        write_vertices(shown, args.vertices)
        files.append(str(args.vertices))
    drawn = draw_turntable(
        shown,
        args.output or Path("view.png"),
        args.size or PICTURE_SIZE,
        frames=args.frames,
        backend=args.backend,
        profile=args.profile,
        camera=args.camera,
        caption=args.caption,
        video=args.video,
    )
    found = {**_describe(shown), **asdict(drawn), "files": [*drawn.files, *files]}
    answer(args, found, _lines(found))
    return 0


def _draw_sheet(args: argparse.Namespace) -> int:
    from mimics_app.app.viewer.contact_sheet import draw_sheet

    sheet = draw_sheet(args.sheet, args.output, backend=args.backend)
    models = [
        {"file": tile.file, "ok": tile.shown, "empty": tile.empty, **errors_of(tile.issues)} for tile in sheet.tiles
    ]
    shown = sum(tile.shown for tile in sheet.tiles)
    for tile in () if args.json else sheet.tiles:
        sys.stderr.writelines(issue_lines(tile.issues))
    drawn = {"shown": shown, "backend": sheet.backend, "gl": sheet.gl, "files": [sheet.file], "models": models}
    answer(args, drawn, [f"{shown} of {len(sheet.tiles)} models shown", str(sheet.file)])
    return 0 if shown == len(sheet.tiles) else SceneError.exit_code


def _describe(shown: Shown) -> dict[str, Any]:
    from mimics_app.app.viewer.playing import clips_of

    return {"title": shown.title, "holds": shown.size, "clips": clips_of(shown), "notes": shown.notes}


def _lines(found: dict[str, Any]) -> list[str]:
    clips = [f"clips {', '.join(found['clips'])}"] if found["clips"] else []
    notes = [f"note {note}" for note in found["notes"]]
    return [
        f"{found['title']}: {found['holds']}",
        *clips,
        *notes,
        *map(str, [*found["files"], *found.get("saved", [])]),
    ]
