"""Techniques of the installation: shaders/techniques.json."""

from __future__ import annotations

from functools import cache

from mimics_app.contracts.system import resources
from mimics_app.world.components.registry import Component
from mimics_app.world.content.materials.technique import TechniqueSpec
from mimics_app.world.files.reading.struct_file import read_struct_file

__all__ = ["built_in_techniques"]


class _Library(Component, frozen=True):
    techniques: dict[str, TechniqueSpec]


@cache
def built_in_techniques() -> dict[str, TechniqueSpec]:
    """Return the techniques of the installation.

    Raises:
        SceneError: the file cannot be read, or all faults of its techniques.
    """
    return read_struct_file(resources.root() / "shaders" / "techniques.json", _Library).techniques
