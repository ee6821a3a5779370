"""`mimics scenes`: list the shipped scenes by the names that every command accepts."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import asdict

from mimics_app.app.scenes.shipped import GROUPS, shipped_scenes
from mimics_app.app.terminal.output import answer

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""


def run(args: argparse.Namespace) -> int:
    """List the shipped scenes by group."""
    answer(args, {"scenes": [asdict(scene) for scene in shipped_scenes()]}, _lines())
    return 0


def _lines() -> Iterator[str]:
    for group, title in GROUPS.items():
        scenes = [scene for scene in shipped_scenes() if scene.group == group]
        width = max(len(scene.name) for scene in scenes)
        yield title
        for scene in scenes:
            facts = "; ".join(part for part in (scene.takes, scene.lasts) if part)
            yield f"  {scene.name:{width}}  {scene.title} ({facts})"
        yield ""
