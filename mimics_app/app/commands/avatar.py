"""`mimics avatar import FILE`: print which joint of a person's model is which bone, and which were guessed."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import Issue, SceneError

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics avatar`."""
    parser.epilog = (
        "The table of a VRM file is taken as it is. Joint names of VRM, Mixamo, Blender, Rigify, Unreal, Biped, "
        "MotionBuilder, Maya, Character Creator and Daz are known; others are guessed from their positions."
    )
    parser.add_argument("action", choices=("import",), help="import: print which joint of the model is which bone")
    parser.add_argument("file", type=Path, help=".glb, .gltf or .vrm model of a person")


def run(args: argparse.Namespace) -> int:
    """Print the bones found; exit code 3 when a required one is missing.

    Raises:
        SceneError: The file is faulty, or has neither a skeleton nor an animation.
    """
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
