"""Section of a kind of task in the report of a run: tiles, the figure of the movement, and traces over time.

It is data; the report draws it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.phrases import phrase

__all__ = ["Marks", "PlottedCurve", "ReportSection", "ReportedAttempt", "Traces", "TunnelShape", "Word", "frontal"]

Traces = Mapping[str, Mapping[str, tuple[str, F8]]]
"""Axis label with unit -> style -> (name, values) of a line."""


@dataclass(frozen=True, slots=True)
class TunnelShape:
    """Bisector and radius of a tunnel, sampled along its length: world frame [m], shapes [n, 3] and [n]."""

    bisector_world: F8
    radius: F8


class ReportedAttempt(Protocol):
    """One attempt at a trial."""

    @property
    def samples(self) -> NDArray[Any]:
        """SAMPLE records, shape [n]."""
        ...

    @property
    def free(self) -> NDArray[np.bool_]:
        """True for samples where the person led, False where the robot was driven, shape [n]."""
        ...

    @property
    def tunnel(self) -> TunnelShape | None:
        """Tunnel of the attempt, or None."""
        ...

    @property
    def row(self) -> Mapping[str, Any]:
        """Its row of trials.csv, {} for none."""
        ...


@dataclass(frozen=True, slots=True)
class PlottedCurve:
    """A line in the frontal plane, lateral and vertical [m].

    Attributes:
        points: Points of the line, shape [n, 2]; NaN interrupts it.
        style: Style of the report: "robot", "wall", "bisector", "carried", "measured", "rendered".
        label: Entry in the legend, "" for none.
    """

    points: F8
    style: str
    label: str = ""


@dataclass(frozen=True, slots=True)
class Marks:
    """Points in the frontal plane [m], shape [n, 2], with a tooltip each."""

    points: F8
    label: str
    hovers: Sequence[str]
    style: str = "contact"


@dataclass(frozen=True, slots=True)
class Word:
    """A label at a point of the frontal plane [m], offset along a direction, shape [2] each."""

    text: str
    place: F8
    outward: F8


class ReportSection:
    """Default section with the path of the hand; kinds of tasks extend it.

    Attributes:
        heading: Heading of the section.
        colours: Sentence that explains the colours.
        touching: Term for being in contact.
        contact: Term for the beginning of a contact.
        path_error: Caption of the tile with the path error.
        contacts: Caption of the tile with the number of contacts.
        from_floor: Whether the figure starts at height 0.
    """

    heading: ClassVar[str] = phrase("Movement of the hand")
    colours: ClassVar[str] = phrase("The handle path is blue.")
    touching: ClassVar[str] = phrase("touching")
    contact: ClassVar[str] = phrase("contact begins")
    path_error: ClassVar[str] = phrase("distance from the line")
    contacts: ClassVar[str] = phrase("contacts")
    from_floor: ClassVar[bool] = False

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        """Whether a run is of this kind, by the scenario's facts and the recorded attempts."""
        return True

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        """Return figures of the run by caption: value (None: left out) and unit; `task` holds the session's totals."""
        return {}

    def behind(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[PlottedCurve]:
        """Return the curves in the background of the path."""
        return ()

    def hand(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[PlottedCurve]:
        """Return the path of the hand where the person led."""
        return [PlottedCurve(np.where(attempt.free[:, None], frontal(attempt), np.nan), "robot", phrase("handle path"))]

    def marks(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Marks]:
        """Return marked points of the path."""
        return ()

    def words(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Word]:
        """Return the labels in the figure."""
        return ()

    def traces(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Traces:
        """Return lines over time, besides force, velocity and stability."""
        return {}


def frontal(attempt: ReportedAttempt) -> F8:
    """Return the path of the hand in the frontal plane, lateral and vertical [m], shape [n, 2]."""
    path: F8 = attempt.samples["hip_world"][:, :2]
    return path
