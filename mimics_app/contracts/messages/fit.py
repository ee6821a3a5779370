"""What a calibration asks of a session, and how far a therapist lets it go."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from mimics_app.contracts.commands.vocabulary import LOUDEST
from mimics_app.contracts.messages.calibration_record import DIRECTIONS, Calibration

__all__ = ["Fit", "FitLimits", "fit_of"]

_Share = Annotated[float, Meta(gt=0.0, le=1.0)]
_Factor = Annotated[float, Meta(ge=1.0, le=2.0)]

_HEADROOM_DB = 35.0
"""Level of sounds above the softest one that the better ear perceives [dB]."""
_MOST_DB = 100.0
"""Beyond every `FitLimits.volume`: a level in a file may be any number [dB]."""
_RESERVE, _SMALLEST_CAPITAL = 2.0, 10.5
"""Size of text over that of the smallest letter that is read, a setting; smallest capitals of the board [px]."""


class FitLimits(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """How far the tasks may be fitted.

    Attributes:
        on: False: the tasks stay as they are.
        range: Which range of motion counts.
        reach: Share of that range that a task uses.
        least_reach: Smallest factor on the paths of a task.
        grip: Share of the grip strength that a task asks for.
        text: Largest factor on the size of text.
        volume: Largest factor on the volume.
    """

    on: bool = True
    range: Literal["comfortable", "maximal"] = "comfortable"
    reach: _Share = 0.95
    least_reach: _Share = 0.4
    grip: _Share = 0.5
    text: _Factor = 1.6
    volume: Annotated[float, Meta(ge=1.0, le=LOUDEST)] = 2.0


class Fit(msgspec.Struct, frozen=True):
    """What fits a person.

    Attributes:
        reaches: How far a task may take the hand from its rest, by direction [m]; {}: anywhere.
        least_reach: Smallest factor on the paths of a task.
        grip: Largest grip that a task asks for [N]; None: any.
        walking: Largest walking speed [m/s]; None: any.
        text: Factor on the size of text.
        volume: Factor on the volume.
        source: Run folder of the calibration.
    """

    reaches: Mapping[str, float] = {}
    least_reach: float = 1.0
    grip: float | None = None
    walking: float | None = None
    text: float = 1.0
    volume: float = 1.0
    source: str = ""


def fit_of(calibration: Calibration, limits: FitLimits) -> Fit:
    """Return what fits the person of a calibration, within limits; what was not measured stays as it is."""
    if not limits.on:
        return Fit()
    prefix = "ease" if limits.range == "comfortable" else "reach"
    found = {name: calibration.value(f"{prefix}_{name}") for name in DIRECTIONS}
    strength = calibration.value("grip")
    return Fit(
        {name: limits.reach * value for name, value in found.items() if value is not None},
        limits.least_reach,
        None if strength is None else limits.grip * strength,
        calibration.value("walking"),
        _text(calibration.value("letter"), limits.text),
        _volume(calibration, limits.volume),
        calibration.source,
    )


def _text(letter: float | None, most: float) -> float:
    return 1.0 if letter is None else min(max(_RESERVE * letter / _SMALLEST_CAPITAL, 1.0), most)


def _volume(calibration: Calibration, most: float) -> float:
    sides = [calibration.value(f"hearing_{side}") for side in ("left", "right")]
    known = [level for level in sides if level is not None]
    if not known:
        return 1.0
    gain: float = 10.0 ** (min(min(known) + _HEADROOM_DB, _MOST_DB) / 20.0)
    return min(max(gain, 1.0), most)
