"""Techniques of the installation: shaders/techniques.json."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from mimics_app.contracts import resources
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.components.struct_reader import FAILED, is_comment, read_struct
from mimics_app.world.materials.technique import TechniqueSpec
from mimics_app.world.scene.json_text import parse_json
from mimics_app.world.scene.scene_files import read_bytes

__all__ = ["built_in_techniques"]


@cache
def built_in_techniques() -> dict[str, TechniqueSpec]:
    """Return the techniques of the installation."""
    return _read_techniques(resources.root() / "shaders" / "techniques.json")


def _read_techniques(path: Path) -> dict[str, TechniqueSpec]:
    """Read a file of techniques.

    Raises:
        SceneError: it cannot be read, or all faults of its techniques.
    """
    document, issues = parse_json(read_bytes(path, str(path)), str(path))

    def report(pointer: str, what: str, fix: str) -> None:
        issues.append(Issue(str(path), pointer, what, fix))

    plain = document.get("techniques") if isinstance(document, dict) else None
    wanted = {key: value for key, value in plain.items() if not is_comment(key)} if isinstance(plain, dict) else {}
    read = read_struct(dict[str, TechniqueSpec], wanted, report, "/techniques")
    if issues or read is FAILED or not wanted:
        raise SceneError(issues or Issue(str(path), "/techniques", "has no techniques"))
    return dict(read)
