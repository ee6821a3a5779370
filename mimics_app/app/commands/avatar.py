"""`mimics avatar import FILE` and `mimics avatar make`: joints of a person's model; a person of given measures."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.terminal.arguments import file_to_write, real_number
from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import Issue, SceneError, UsageError, require_choice

if TYPE_CHECKING:
    from mimics_app.world.files.people.fitted_person import Reached

__all__ = ["add_arguments", "run"]

_height = real_number("height from 1.2 to 2.2 m", lambda metres: 1.2 <= metres <= 2.2)
_weight = real_number("weight from 30 to 220 kg", lambda kilograms: 30.0 <= kilograms <= 220.0)
_age = real_number("age from 14 to 110 years", lambda years: 14.0 <= years <= 110.0)
_NEEDED = ("height", "weight", "age", "sex", "out")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics avatar`."""
    parser.epilog = (
        "The table of a VRM file is taken as it is. Joint names of VRM, Mixamo, Blender, Rigify, Unreal, Biped, "
        "MotionBuilder, Maya, Character Creator and Daz are known; others are guessed from their positions. "
        "docs/guide/avatars.md lists the measures of a person."
    )
    parser.add_argument(
        "action",
        choices=("import", "make"),
        help="import: print which joint of the model is which bone; make: write a person of given measures",
    )
    parser.add_argument("file", type=Path, nargs="?", help="with import: .glb, .gltf or .vrm model of a person")
    made = parser.add_argument_group("with make")
    made.add_argument("--height", type=_height, metavar="M", help="height without shoes [m]")
    made.add_argument("--weight", type=_weight, metavar="KG", help="weight [kg]")
    made.add_argument("--age", type=_age, metavar="YEARS", help="age [years]")
    made.add_argument("--sex", choices=("f", "m"), help="f or m")
    made.add_argument("--measures", type=Path, metavar="FILE", help="lengths and girths [m], a JSON object by name")
    made.add_argument(
        "--like", default="", metavar="NAME", help="shipped person with the face and clothes (default: the nearest)"
    )
    made.add_argument("--out", type=file_to_write, metavar="FILE", help="the .glb file to write")


def run(args: argparse.Namespace) -> int:
    """Run one of the actions."""
    return {"import": _import, "make": _make}[args.action](args)


def _import(args: argparse.Namespace) -> int:
    """Print the bones found; exit code 3 when a required one is missing.

    Raises:
        UsageError: No file is named.
        SceneError: The file is faulty, or has neither a skeleton nor an animation.
    """
    if args.file is None:
        raise UsageError("import needs the file of a model", "mimics avatar import FILE")
    from mimics_app.app.scenes.scene_search import find_file
    from mimics_app.app.terminal.named import check_file

    file = find_file(args.file)
    check_file(file)
    from mimics_app.world.content.motion.humanoid import find_humanoid, report_lines
    from mimics_app.world.content.world import World
    from mimics_app.world.files.scene.model_world import read_model

    world, model = World(), read_model(file)
    model.instantiate(world, world.root)
    animators = list(world.motion.animators.values())
    if not animators:
        raise SceneError(Issue(str(file), "/skins", "nothing in the model moves: it has neither a skin nor a clip"))
    found = find_humanoid(animators[0].rig)
    clips, morphs = list(animators[0].clips), sorted(set(animators[0].rig.morph_names) - {""})
    bones = {"file": str(file), "bones": found.names, "guessed": found.guesses, "missing": list(found.missing)}
    notes = model.document.notes
    lines = report_lines(found, [*([f"clips: {', '.join(clips)}"] if clips else []), *notes])
    answer(args, {**bones, "clips": clips, "morphs": morphs, "notes": notes}, lines)
    return 0 if found.complete else SceneError.exit_code


def _make(args: argparse.Namespace) -> int:
    """Write a person, and print each measure as it was asked and reached.

    Raises:
        UsageError: An argument is missing, or The shipped person is unknown.
        SceneError: The file of measures is faulty.
    """
    missing = [f"--{name}" for name in _NEEDED if getattr(args, name) is None]
    if args.file is not None or missing:
        what = f"make takes no file {args.file}" if args.file is not None else f"make needs {', '.join(missing)}"
        raise UsageError(what, "mimics avatar make --height 1.72 --weight 70 --age 60 --sex f --out person.glb")
    if args.out.suffix.lower() != ".glb":
        raise UsageError(f"{args.out} does not end in .glb", "name a .glb file")
    import msgspec

    from mimics_app.contracts.system.whole_file import whole_file
    from mimics_app.world.files.people.body_table import read_bodies
    from mimics_app.world.files.people.fitted_person import Asked, fit_person
    from mimics_app.world.files.people.measures_file import read_measures

    if args.like:
        require_choice(args.like, read_bodies(), "shipped person")
    measures = {} if args.measures is None else read_measures(args.measures)
    asked = Asked(args.height, args.weight, args.age, args.sex, measures)
    fitted = fit_person(asked, args.like)
    about = msgspec.to_builtins(asked) | {"like": fitted.like}
    data = fitted.model.to_bytes(args.out.stem, about)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(args.out):
        args.out.write_bytes(data)
    rows = [msgspec.to_builtins(row) for row in fitted.measures]
    lines = [f"{args.out}: like {fitted.like}", *map(_line, fitted.measures)]
    answer(args, {"file": str(args.out), "like": fitted.like, "measures": rows}, lines)
    return 0


def _line(row: Reached) -> str:
    """Return the line of one measure."""
    unit, digits = ("kg", 1) if row.name == "weight" else ("m", 3)
    value = f"{row.name:16} {row.value:8.{digits}f} {unit:2}"
    if row.asked is None:
        return f"{value}  derived"
    if row.reached:
        return f"{value}  requested: {row.asked:.{digits}f}"
    return f"{value}  NOT REACHED, requested: {row.asked:.{digits}f} (beyond what a shipped body allows)"
