"""Kinds of displays, built in and of installed packages, and the parser of `--display`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.plugins import PluginGroup, fault_of_builder
from mimics_app.contracts.system.phrases import phrase

__all__ = [
    "DISPLAY_KINDS",
    "PLUGINS",
    "DisplayChoice",
    "DisplayKind",
    "display_names",
    "kind_of_display",
    "parse_display",
]


def _fault_of(name: str, loaded: object) -> str:
    from mimics_app.contracts.ports.display_port import Display

    return fault_of_builder(Display)(name, loaded)


PLUGINS = PluginGroup("mimics_app.displays", _fault_of)
"""Displays of installed packages."""


class DisplayKind(NamedTuple):
    """A kind of display.

    Attributes:
        caption: What it is, in a few words.
        file: Whether it takes a file.
    """

    caption: str
    file: Literal["never", "may", "must"] = "never"


DISPLAY_KINDS = {
    "desktop": DisplayKind(phrase("this screen")),
    "sbs": DisplayKind(phrase("3D, side by side")),
    "sbs-half": DisplayKind(phrase("3D, side by side, half width")),
    "tb": DisplayKind(phrase("3D, top and bottom")),
    "interleaved": DisplayKind(phrase("3D, line by line")),
    "anaglyph": DisplayKind(phrase("3D, red and cyan glasses")),
    "quad": DisplayKind(phrase("3D, shutter glasses")),
    "wall": DisplayKind(phrase("a wall seen by a tracked head"), "must"),
    "cave": DisplayKind(phrase("walls around a tracked head"), "must"),
    "hmd": DisplayKind(phrase("head-mounted display"), "may"),
    "openxr": DisplayKind(phrase("headset")),
    "sim-hmd": DisplayKind(phrase("simulated headset"), "may"),
}
"""Built-in kinds of `--display`."""


def kind_of_display(name: str) -> DisplayKind:
    """Return a kind by its name; a plug-in may take a file."""
    return DISPLAY_KINDS.get(name, DisplayKind(name, "may"))


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
    wants = kind_of_display(kind).file
    if wants == "must" and not file:
        raise UsageError(f"the display {kind} needs a file", f"write {kind}:FILE.json")
    if colon and wants == "never":
        raise UsageError(f"the display {kind} takes no file", f"write {kind}")
    return DisplayChoice(kind, file)
