"""The study that the participants' page makes where a folder has none: two tasks of the hand, and the shipped forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.study.forms import SHIPPED_FORMS
from mimics_app.app.study.study_folder import StudyFolder

__all__ = ["USUAL_STUDY", "studies_in", "usual_study"]

USUAL_STUDY = "participants"
"""Name of its folder."""
_SCENES = ("wavy_tunnel", "pick_and_place")
_FORMS = ("person", "nasa_tlx")
_SESSIONS = 20


def studies_in(folder: Path) -> list[Path]:
    """Return the folders of the studies in a folder, by name."""
    return sorted(each.parent for each in folder.glob("*/study.json"))


def usual_study(folder: Path) -> StudyFolder:
    """Make the study in a folder.

    Raises:
        OutputError: Its folder exists, or cannot be made.
    """
    protocol: dict[str, Any] = {
        "format": "mimics study",
        "version": 1,
        "title": "",
        "sessions": _SESSIONS,
        "conditions": {scene: {"scene": scene} for scene in _SCENES},
        "blocks": [{"conditions": list(_SCENES)}],
        "forms": {name: msgspec.to_builtins(SHIPPED_FORMS[name]) for name in _FORMS},
    }
    return StudyFolder.create(folder / USUAL_STUDY, protocol)
