"""Mechanical power of both legs in a gait orthosis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from mimics_app.contracts.messages.feature_names import LEG_POWER
from mimics_app.dsp.channels.power import Power

__all__ = ["CHANNEL", "LegPower"]


class LegPower(Power):
    """Mechanical power of both legs on the orthosis [W]: its mean over a second."""

    name: ClassVar[str] = "leg_power"
    features: ClassVar[Mapping[str, str]] = {LEG_POWER: "W"}


CHANNEL = LegPower
