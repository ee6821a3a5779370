"""What a page cannot show whole: its words end in an ellipsis."""

from __future__ import annotations

import pytest

from mimics_app.rendering.visual.figures.hud import Hud

__all__ = ["watch_cut_words"]


def watch_cut_words(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return a list that grows by every line that a display cuts from now on."""
    cut: list[str] = []
    whole = Hud._shorten

    def shorten(hud: Hud, text: str, size: float, width: float, *, bold: bool) -> str:
        cut.extend([text] if hud.measure(text, size, bold=bold) > width else [])
        return whole(hud, text, size, width, bold=bold)

    monkeypatch.setattr(Hud, "_shorten", shorten)
    return cut
