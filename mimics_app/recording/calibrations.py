"""The calibration that a run recorded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.messages.calibration_record import CALIBRATED, NOT_MEASURED, CalibratedMeasure, Calibration
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run import Run

__all__ = ["calibration_of"]


def calibration_of(run: Run) -> Calibration | None:
    """Return the calibration that a run recorded; of a step that was repeated, the last one.

    Returns:
        None where nothing was measured.

    Raises:
        SceneError: Its journal is damaged.
    """
    lines = [line for line in run.lines if line.get("source") == "app"]
    try:
        measures, skipped = _measures(lines), _skipped(lines)
    except (msgspec.ValidationError, KeyError) as error:
        what = f"a line of the calibration is damaged: {error}"
        raise SceneError(Issue(str(run.folder), "", what, "repeat the calibration")) from error
    begun = str(mapping(run.session.get("clock")).get("utc", ""))
    return Calibration(measures, skipped, run.folder.name, begun) if measures else None


def _measures(lines: Iterable[Mapping[str, Any]]) -> dict[str, CalibratedMeasure]:
    found = [msgspec.convert(line, CalibratedMeasure) for line in lines if line.get("kind") == CALIBRATED]
    return {measure.name: measure for measure in found}


def _skipped(lines: Iterable[Mapping[str, Any]]) -> dict[str, str]:
    return {str(line["step"]): str(line["why"]) for line in lines if line.get("kind") == NOT_MEASURED}
