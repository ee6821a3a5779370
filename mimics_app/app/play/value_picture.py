"""Value function of a learning avatar, drawn as a table into the run folder during a session."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.learning.stepwise import GAPS, SECTORS, StepAgent
from mimics_app.plotting.drawing import document
from mimics_app.plotting.marks import element, word
from mimics_app.recording.run_folder import write_atomically

__all__ = ["ValuePicture", "draw_values"]

_EVERY = 5 * FRAMES_PER_SECOND
_NAME = "value_function.svg"
_DEEDS = ("approach", "retreat", "step aside", "wait", "beckon", "point")
_CELL = (96.0, 34.0)
_LEFT, _TOP = 250.0, 76.0
_DIGITS = 2
"""Decimal places of a printed value."""
_DARKEST = 0.6
"""Opacity of the cell with the largest value, at which its number is still legible."""


class ValuePicture:
    """Draws the picture every five seconds of a session.

    Args:
        session: The session; nothing is drawn unless its learning system is a `StepAgent`.
    """

    def __init__(self, session: Session) -> None:
        self._agent = session.learning if isinstance(session.learning, StepAgent) else None
        self._path = session.folder / _NAME

    def update(self, frames: Frames) -> None:
        """Draw after a frame where the picture is due."""
        if self._agent is not None and frames.number % _EVERY == 0:
            draw_values(self._agent.table.values, self._path)


def draw_values(values: NDArray[np.float64], path: Path) -> None:
    """Draw values, shape [states, actions], as a table; larger values are darker, and the largest of a state is framed.

    A state whose largest value is not unique as printed has no frame: it was not visited yet.
    """
    width, height = _CELL
    low, span = float(values.min()), float(np.ptp(values)) or 1.0
    names = _DEEDS if values.shape[1] == len(_DEEDS) else tuple(str(i) for i in range(values.shape[1]))
    parts = [word(_LEFT + (j + 0.5) * width, _TOP - 10.0, name, "name", "middle") for j, name in enumerate(names)]
    for i, row in enumerate(values):
        y = _TOP + i * height
        parts.append(word(_LEFT - 12.0, y + 0.62 * height, _state(i), "small", "end"))
        for j, value in enumerate(row.tolist()):
            x = _LEFT + j * width
            shade = f"{_DARKEST * (value - low) / span:.3f}"
            parts.append(element("rect", class_="dot", x=x, y=y, width=width, height=height, fill_opacity=shade))
            parts.append(word(x + 0.5 * width, y + 0.62 * height, f"{value:.{_DIGITS}f}", "name", "middle"))
    for i, row in enumerate(values.round(_DIGITS)):  # after all cells, which would cover the lower edge of the frame
        best = np.flatnonzero(row == row.max())
        if len(best) > 1:
            continue
        x, y = _LEFT + int(best[0]) * width, _TOP + i * height
        parts.append(element("rect", class_="ring", x=x, y=y, width=width, height=height))
    whole = (_LEFT + len(names) * width + 20.0, _TOP + len(values) * height + 40.0)
    foot = [
        "Expected reward of each action in this and later steps: distance gained [m], or what a state lacks to its "
        "band. Framed: the best action; none where several are equal."
    ]
    write_atomically(path, str(document(*whole, "What the avatar has learnt", parts, foot)).encode())


def _state(i: int) -> str:
    """Return a state in words: where the guide is as the person sees it who looks towards the place."""
    borders = ("0", *(f"{gap:g}" for gap in GAPS))
    sector, k = divmod(i, len(GAPS) + 1)
    distance = f"{borders[k]} to {GAPS[k]:g} m" if k < len(GAPS) else f"over {GAPS[-1]:g} m"
    angle = round(math.remainder(360.0 * sector / SECTORS, 360.0))
    hand = "right" if angle > 0 else "left"
    side = {0: "before the person", 180: "behind the person"}.get(abs(angle), f"{abs(angle)} degrees to the {hand}")
    return f"{side}, {distance}"
