"""Language of the participant where none is named: as last chosen in the launcher, else the system's."""

from __future__ import annotations

from mimics_app.app.terminal.user_files import LAUNCHER, read_config
from mimics_app.contracts.system.language import LANGUAGES, system_language

__all__ = ["usual_language"]


def usual_language() -> str:
    """Return the code of the language, one of LANGUAGES."""
    settings = read_config(LAUNCHER).get("settings")
    chosen = str(settings.get("language", "")) if isinstance(settings, dict) else ""
    return chosen if chosen in LANGUAGES else system_language()
