"""`mimics scenes`: list the shipped scenes by the names that every command accepts."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""


def run(args: argparse.Namespace) -> int:
    """List them."""
    from mimics_app.app.scenes.shipped import shipped_scenes

    if args.json:
        from mimics_app.app.terminal.output import write_object

        write_object("scenes", {"scenes": [scene.as_dict() for scene in shipped_scenes()]})
    else:
        sys.stdout.write("\n".join(_lines()) + "\n")
    return 0


def _lines() -> Iterator[str]:
    from mimics_app.app.scenes.shipped import GROUPS, shipped_scenes

    for group, title in GROUPS.items():
        scenes = [scene for scene in shipped_scenes() if scene.group == group]
        width = max(len(scene.name) for scene in scenes)
        yield title
        for scene in scenes:
            facts = "; ".join(part for part in (scene.takes, scene.lasts) if part)
            yield f"  {scene.name:{width}}  {scene.title} ({facts})"
        yield ""
