"""The experiment with the cord in the report: answers, and timing of the taps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mimics_app.contracts.report_section import ReportedAttempt, ReportSection

__all__ = ["AvatarCordSection"]


class AvatarCordSection(ReportSection):
    """Section of runs with trials of the experiment."""

    heading = "Connection to an avatar"
    colours = "The handle path, where the subject held the robot, is blue."

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return any("tap_error_ms" in attempt.row for attempt in attempts)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {
            "ownership": (task.get("ownership"), ""),
            "drift towards the avatar": (task.get("drift_m"), "m"),
            "taps off their time, mean of the trials' worst": (task.get("tap_error_ms"), "ms"),
        }
