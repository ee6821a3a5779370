"""Input of the person to the haptic loop, one INBOX record per frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.haptic import INBOX
from mimics_app.contracts.messages.stage_messages import PointerState
from mimics_app.rendering.haptic.engine import HapticEngine

__all__ = ["PersonInbox"]


class PersonInbox:
    """Inbox of the device of a loop.

    Args:
        haptics: The haptic loop.
    """

    def __init__(self, haptics: HapticEngine) -> None:
        self._haptics = haptics
        self._record: NDArray[Any] = np.zeros(1, INBOX)

    def send(self, pointer: PointerState | None, *, trial: int, may_act: bool) -> None:
        """Send the pointer of a frame.

        Args:
            pointer: State of the pointing device; None keeps the last position and marks the person as inactive.
            trial: Number of the present trial.
            may_act: False while the robot leads.
        """
        record = self._record[0]
        record["active"] = int(may_act and pointer is not None and pointer.active)
        record["trial"] = trial
        if pointer is not None:
            record["target_world"], record["grasp"] = pointer.target_world, pointer.grasp
        self._haptics.send(self._record)
