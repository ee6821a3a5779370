"""Kinds of channel by the name of their signal: the built-in ones, and those of installed packages."""

from __future__ import annotations

from typing import cast

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.feature_names import RSA
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup
from mimics_app.dsp import channels
from mimics_app.dsp.channel import Channel

__all__ = ["BUILT_IN", "PLUGINS", "channel_kind", "check_rate", "feature_units"]

BUILT_IN = member_names(channels)
"""Signals that the product processes; those of other names are processed by plug-ins, or only recorded."""

_HIGHEST_RATE = 20_000.0
"""Highest sampling rate that is processed [Hz]."""


def _fault_of(name: str, loaded: object) -> str:
    if not isinstance(loaded, type) or not issubclass(loaded, Channel):
        return f"is not a class derived from {Channel.__module__}.{Channel.__name__}"
    wanted = ("name", "unit", "features", "latency_s", "lowest_rate")
    if lacking := [each for each in wanted if not hasattr(loaded, each)]:
        return f"lacks {', '.join(lacking)}, see {Channel.__module__}.{Channel.__name__}"
    return "" if loaded.name == name else f'processes the signal "{loaded.name}", not "{name}"'


PLUGINS = PluginGroup("mimics_app.signal_channels", _fault_of)


def channel_kind(name: str) -> type[Channel] | None:
    """Return the class that processes a signal; None for one that is only recorded.

    Raises:
        DeviceError: Its plug-in cannot be loaded.
    """
    if name in BUILT_IN:
        return cast(type[Channel], load_member(channels, name, "CHANNEL", type))
    if name not in PLUGINS.names():
        return None
    try:
        return cast(type[Channel], PLUGINS.load(name))
    except PluginError as error:
        raise DeviceError(f'the signal "{name}" cannot be processed: {error}') from error


def check_rate(name: str, rate: float) -> None:
    """Check that a signal can be processed at a rate [Hz]; one that is only recorded has any.

    Raises:
        DeviceError: It cannot.
    """
    kind = channel_kind(name)
    lowest = kind.lowest_rate if kind else 0.0
    if not lowest <= rate <= _HIGHEST_RATE:
        raise DeviceError(
            f'the rate of the signal "{name}" is {rate:g} Hz, which cannot be processed',
            f"set a rate from {lowest:g} to {_HIGHEST_RATE:g} Hz",
        )


def feature_units() -> dict[str, str]:
    """Return the unit of each feature by its name; "1": a ratio, a flag, or the unit of a signal without one."""
    built_in = [kind for name in BUILT_IN if (kind := channel_kind(name)) is not None]
    installed = [cast(type[Channel], plugin) for _, plugin in PLUGINS.load_sound("signal channel")]
    units = {name: unit for kind in (*built_in, *installed) for name, unit in kind.features.items()}
    return units | {RSA: "ms"}
