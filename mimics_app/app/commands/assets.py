"""`mimics assets ACTION [NAME]`: build the shipped models, sounds and pictures, and levels of detail of models."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.terminal.arguments import folder_to_write, picture_file, real_number, whole_number
from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import UsageError, counted
from mimics_app.contracts.system.regular_file import read_regular

if TYPE_CHECKING:
    from mimics_app.world.files.simplify.level_writer import MeshLevels

__all__ = ["add_arguments", "run"]

_SIDES = 6
"""Number of directions from which a built model is drawn."""

_seed = whole_number("whole number", range(2**63))
_share = real_number("share between 0 and 1", lambda share: 0.0 < share < 1.0)
_pixels = real_number("number of pixels between 0 and 1000", lambda pixels: 0.0 < pixels < 1000.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "action",
        choices=("build", "list", "levels", "thumbnails"),
        help="build: write the files of NAME; list: list the names (both need a checkout); levels: write a copy of a "
        "model with levels of detail; thumbnails: draw the launcher's pictures of the shipped scenes, or of the scene "
        "NAME alone",
    )
    parser.add_argument("name", nargs="?", default="", help="builder or scene; with levels: a .glb or .gltf file")
    parser.add_argument(
        "--seed",
        type=_seed,
        default=1,
        help="seed of build: the same seed gives the same bytes; on another processor the last digit of a sine may "
        "differ",
    )
    parser.add_argument("--out", type=folder_to_write, default=Path("."), metavar="DIR", help="folder to write into")
    parser.add_argument(
        "--picture",
        type=picture_file,
        metavar="PNG",
        help="with build: draw each model from six directions, or the spectrograms of sounds; with thumbnails: draw "
        "all of them on one sheet",
    )
    parser.add_argument(
        "--shares",
        type=_share,
        nargs="+",
        metavar="SHARE",
        help="with levels: share of the triangles kept at each level, largest first (0.5 0.2 0.06)",
    )
    parser.add_argument("--pixels", type=_pixels, default=1.0, help="with levels: largest visible error [px]")


def run(args: argparse.Namespace) -> int:
    """List the builders, run one, simplify a model, or draw the launcher's pictures."""
    return {"list": _list, "build": _build, "levels": _levels, "thumbnails": _thumbnails}[args.action](args)


def _require_builders() -> None:
    """Raise a UsageError where the builders are not installed: they are part of a checkout alone."""
    from mimics_app.contracts.system.resources import root

    if not (root() / "assets" / "builders").is_dir():
        raise UsageError(
            "this installation has no builders of the shipped files", "run mimics from a checkout of the repository"
        )


def _list(args: argparse.Namespace) -> int:
    _require_builders()
    from assets.builders.catalogue import find_builders

    builders = find_builders()
    rows = [{"name": each.name, "what": each.what, "file": each.file} for each in builders]
    answer(args, {"builders": rows}, (f"{each.name:12} {each.what}" for each in builders))
    return 0


def _levels(args: argparse.Namespace) -> int:
    import sys
    from dataclasses import asdict

    from mimics_app.app.scenes.scene_search import find_file
    from mimics_app.app.terminal.named import check_file
    from mimics_app.app.terminal.progress import ProgressBar

    if not args.name:
        raise UsageError("the model is missing", "mimics assets levels MODEL.glb")
    file = find_file(Path(args.name))
    check_file(file)
    from mimics_app.world.files.simplify.level_writer import SHARES, write_levels

    out = args.out / f"{file.stem}_levels.glb"
    try:
        with ProgressBar(sys.stderr) as bar:
            levels = write_levels(file, out, args.shares or SHARES, args.pixels, bar.show)
    except ValueError as error:
        raise UsageError(str(error), "for example --shares 0.5 0.2 0.06") from error
    none = "" if levels else ": every mesh has levels already, or cannot be simplified without a visible error"
    total = f"{out}: levels made for {counted(len(levels), 'meshes')}{none}"
    answer(args, {"file": out, "meshes": [asdict(each) for each in levels]}, [*map(_level_line, levels), total])
    return 0


def _level_line(mesh: MeshLevels) -> str:
    steps = zip(mesh.triangles, mesh.errors, mesh.coverages, strict=True)
    levels = (
        f"{n} triangles, at most {1e3 * error:.2g} mm off, from {100 * c:.2g} % of the picture" for n, error, c in steps
    )
    return f"{mesh.name}: {'; '.join(levels)}"


def _thumbnails(args: argparse.Namespace) -> int:
    from mimics_app.app.play.thumbnails import draw_sheet, draw_thumbnails

    files = []
    for file in draw_thumbnails(args.out, [args.name] if args.name else ()):
        files.append(file)
        if not args.json:
            print(f"{file}: {file.stat().st_size} bytes", flush=True)
    if args.picture is not None:
        draw_sheet(files, args.picture)
    answer(args, {"files": files}, ())
    return 0


def _build(args: argparse.Namespace) -> int:
    _require_builders()
    from assets.builders.catalogue import find_builder

    if not args.name:
        raise UsageError("the name of a builder is missing", "mimics assets list shows the names")
    files = find_builder(args.name).write(args.out, args.seed)
    if args.picture is not None:
        _draw(args.name, files, args.picture)
    rows = [{"file": file, "bytes": file.stat().st_size, "sha256": _digest(file)} for file in files]
    lines = (f"{row['file']}: {row['bytes']} bytes, sha256 {row['sha256']}" for row in rows)
    answer(args, {"name": args.name, "seed": args.seed, "files": rows}, lines)
    return 0


def _draw(name: str, files: list[Path], picture: Path) -> None:
    from mimics_app.app.viewer.contact_sheet import draw_models
    from mimics_app.app.viewer.shown import MODEL_SUFFIXES

    sounds = [file for file in files if file.suffix == ".wav" and not file.stem[-1].isdigit()]  # one of each family
    if sounds:
        from assets.builders.sounds.spectrogram import draw_spectrograms

        return draw_spectrograms(sounds, picture)
    models = [file for file in files if file.suffix in MODEL_SUFFIXES]
    if not models:
        raise UsageError(f"{name} builds neither a model nor a sound", "leave out --picture and open its files")
    draw_models(models, picture, sides=_SIDES)


def _digest(file: Path) -> str:
    import hashlib

    return hashlib.sha256(read_regular(file)).hexdigest()
