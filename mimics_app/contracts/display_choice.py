"""Kinds of displays, and the parser of `--display`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from mimics_app.contracts.errors import UsageError, nearest

__all__ = ["DISPLAY_KINDS", "DisplayChoice", "parse_display"]

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
"""Built-in kinds of `--display`, and whether each takes a file."""


@dataclass(frozen=True, slots=True)
class DisplayChoice:
    """Requested display: KIND or KIND:FILE."""

    kind: str = "desktop"
    file: str = ""

    def __str__(self) -> str:
        return f"{self.kind}:{self.file}" if self.file else self.kind


def parse_display(text: str) -> DisplayChoice:
    """Parse KIND[:FILE]; KIND may be that of a plug-in, which may take a file.

    Raises:
        UsageError: Unknown kind, a missing file, or a file for a kind that takes none.
    """
    kind, colon, file = text.partition(":")
    if kind not in DISPLAY_KINDS:
        from mimics_app.contracts.display_port import PLUGINS

        if kind not in (installed := PLUGINS.names()):
            raise UsageError(f'there is no display "{kind}"', nearest(kind, [*DISPLAY_KINDS, *installed]))
        return DisplayChoice(kind, file)
    wants = DISPLAY_KINDS[kind]
    if wants == "must" and not file:
        raise UsageError(f"the display {kind} needs a file", f"write {kind}:FILE.json")
    if colon and wants == "never":
        raise UsageError(f"the display {kind} takes no file", f"write {kind}")
    return DisplayChoice(kind, file)
