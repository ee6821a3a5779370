"""What a kind of task adds to the report of a run: its tiles, the figure of the movement, and traces over time.

It is data: whoever makes the report draws it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8

__all__ = ["Curve", "Marks", "ReportSection", "ReportedAttempt", "Traces", "TunnelShape", "Word", "frontal"]

Traces = Mapping[str, Mapping[str, tuple[str, F8]]]
"""By the label of an axis with its unit: by style, the name and the values of each line."""


@dataclass(frozen=True, slots=True)
class TunnelShape:
    """Bisector and radius of a tunnel, sampled along its length: world frame [m], shapes [n, 3] and [n]."""

    bisector_world: F8
    radius: F8


class ReportedAttempt(Protocol):
    """One attempt at a trial, as a section sees it."""

    @property
    def samples(self) -> NDArray[Any]:
        """SAMPLE records, shape [n]."""
        ...

    @property
    def free(self) -> NDArray[np.bool_]:
        """Where the person led, shape [n]; elsewhere the robot was driven."""
        ...

    @property
    def tunnel(self) -> TunnelShape | None:
        """The tunnel it went through, None where there is none."""
        ...

    @property
    def row(self) -> Mapping[str, Any]:
        """Its row of trials.csv, {} where it has none."""
        ...


@dataclass(frozen=True, slots=True)
class Curve:
    """A line in the frontal plane, lateral and vertical [m], shape [n, 2]; nan breaks it.

    Attributes:
        points: Where it runs.
        style: One of the report's: "robot", "wall", "bisector", "carried", "measured", "felt".
        label: In the legend, "" for none.
    """

    points: F8
    style: str
    label: str = ""


@dataclass(frozen=True, slots=True)
class Marks:
    """Points in the frontal plane [m], shape [n, 2], with what a pointer over each reads."""

    points: F8
    label: str
    hovers: Sequence[str]
    style: str = "contact"


@dataclass(frozen=True, slots=True)
class Word:
    """A word at a place of the frontal plane [m], pushed away from there along a direction, shape [2] each."""

    text: str
    place: F8
    outward: F8


class ReportSection:
    """The movement of a run in which nothing but the hand's path is known; a kind of task says more.

    Attributes:
        heading: Of the section.
        colours: What its colours mean, a sentence.
        touching: In words, what being in contact is.
        contact: In words, the beginning of a contact.
        path_error: Caption of the tile with the path error.
        contacts: Caption of the tile with the number of contacts.
        from_floor: Whether the figure begins at height 0.
    """

    heading: ClassVar[str] = "Movement of the hand"
    colours: ClassVar[str] = "The handle path is blue."
    touching: ClassVar[str] = "touching"
    contact: ClassVar[str] = "contact begins"
    path_error: ClassVar[str] = "distance from the line"
    contacts: ClassVar[str] = "contacts"
    from_floor: ClassVar[bool] = False

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        """Whether a run is of this kind, by the scenario's facts and what was recorded."""
        return True

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        """Figures of the run by caption: value (None: left out) and unit; `task` holds the session's totals."""
        return {}

    def behind(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Curve]:
        """What the path is drawn over."""
        return ()

    def hand(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Curve]:
        """The path of the hand, where the person led."""
        return [Curve(np.where(attempt.free[:, None], frontal(attempt), np.nan), "robot", "handle path")]

    def marks(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Marks]:
        """Moments on the path."""
        return ()

    def words(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Word]:
        """Words in the figure."""
        return ()

    def traces(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Traces:
        """Lines over time, besides force, velocity and stability."""
        return {}


def frontal(attempt: ReportedAttempt) -> F8:
    """Path of the hand in the frontal plane, lateral and vertical [m], shape [n, 2]."""
    path: F8 = attempt.samples["hip_world"][:, :2]
    return path
