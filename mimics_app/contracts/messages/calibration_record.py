"""What a calibration found of a person: measures with unit, number of repeats and spread."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.system.phrases import phrase

__all__ = [
    "CALIBRATED",
    "DIRECTIONS",
    "MEASURE_TITLES",
    "NOT_MEASURED",
    "CalibratedMeasure",
    "Calibration",
    "newest_of",
]

DIRECTIONS: dict[str, Vec3] = {
    "right": (1.0, 0.0, 0.0),
    "left": (-1.0, 0.0, 0.0),
    "up": (0.0, 1.0, 0.0),
    "down": (0.0, -1.0, 0.0),
    "forward": (0.0, 0.0, -1.0),
    "back": (0.0, 0.0, 1.0),
}
"""Directions of a range of motion, in the world, where the person looks along -z."""

MEASURE_TITLES = {
    **{f"ease_{name}": phrase("comfortable reach {name:s}", name=name) for name in DIRECTIONS},
    **{f"reach_{name}": phrase("reach {name:s}", name=name) for name in DIRECTIONS},
    "grip": phrase("grip strength"),
    "release": phrase("time to let go"),
    "walking": phrase("walking speed"),
    "hearing_left": phrase("hears from the left"),
    "hearing_right": phrase("hears from the right"),
    "letter": phrase("reads letters of"),
}
"""Title of each measure by its name."""

CALIBRATED, NOT_MEASURED = "calibrated", "not_measured"
"""Kinds of the journal's lines with one measure, and with a step that could not be measured."""


class CalibratedMeasure(msgspec.Struct, frozen=True):
    """One measure of a person.

    Attributes:
        name: Its name, such as "reach_right".
        value: The estimate, in `unit`.
        unit: "m", "N", "s", "m/s", "dB", "px".
        repeats: Number of repeats that it is of.
        spread: Largest less smallest of these, in `unit`.
        at_least: Whether the device ended before the person did: the true value is larger.
    """

    name: str
    value: float
    unit: str
    repeats: int
    spread: float
    at_least: bool = False


class Calibration(msgspec.Struct, frozen=True):
    """Result of one calibration.

    Attributes:
        measures: Measures by name.
        skipped: Why a step was not measured, by its name.
        source: Name of the run folder that it is from.
        utc: Begin of that run.
    """

    measures: Mapping[str, CalibratedMeasure]
    skipped: Mapping[str, str] = {}
    source: str = ""
    utc: str = ""

    def value(self, name: str) -> float | None:
        """Return the value of a measure, None where it was not measured."""
        measure = self.measures.get(name)
        return None if measure is None else measure.value


def newest_of(calibrations: Sequence[Calibration]) -> Calibration:
    """Return the newest value of each measure of calibrations in order, at least one: a step may have been left out."""
    measures = {name: measure for each in calibrations for name, measure in each.measures.items()}
    last = calibrations[-1]
    return Calibration(measures, last.skipped, last.source, last.utc)
