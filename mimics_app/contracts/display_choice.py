"""Kinds of displays, built in and of installed packages, and the parser of `--display`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.plugins import PluginGroup, fault_of_builder

__all__ = ["DISPLAY_KINDS", "PLUGINS", "DisplayChoice", "display_names", "parse_display"]


def _fault_of(name: str, loaded: object) -> str:
    from mimics_app.contracts.display_port import Display

    return fault_of_builder(Display)(name, loaded)


PLUGINS = PluginGroup("mimics_app.displays", _fault_of)
"""Displays of installed packages."""

DISPLAY_KINDS: dict[str, Literal["never", "may", "must"]] = {
    "desktop": "never",
    "sbs": "never",
    "sbs-half": "never",
    "tb": "never",
    "interleaved": "never",
    "anaglyph": "never",
    "quad": "never",
    "wall": "must",
    "cave": "must",
    "hmd": "may",
    "openxr": "never",
    "sim-hmd": "may",
}
"""Built-in kinds of `--display`, and whether each takes a file; a plug-in may take one."""


@dataclass(frozen=True, slots=True)
class DisplayChoice:
    """Requested display: KIND or KIND:FILE."""

    kind: str = "desktop"
    file: str = ""

    def __str__(self) -> str:
        return f"{self.kind}:{self.file}" if self.file else self.kind


def display_names() -> list[str]:
    """Return the kinds of all displays: built-in first, then installed plug-ins."""
    return [*DISPLAY_KINDS, *(name for name in PLUGINS.names() if name not in DISPLAY_KINDS)]


def parse_display(text: str) -> DisplayChoice:
    """Parse KIND[:FILE].

    Raises:
        UsageError: Unknown kind, a missing file, or a file for a kind that takes none.
    """
    kind, colon, file = text.partition(":")
    if kind not in DISPLAY_KINDS and kind not in (known := display_names()):
        raise UsageError(f'there is no display "{kind}"', nearest(kind, known))
    wants = DISPLAY_KINDS.get(kind, "may")
    if wants == "must" and not file:
        raise UsageError(f"the display {kind} needs a file", f"write {kind}:FILE.json")
    if colon and wants == "never":
        raise UsageError(f"the display {kind} takes no file", f"write {kind}")
    return DisplayChoice(kind, file)
