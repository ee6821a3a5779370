"""Faults injected into what passes between the loop and a simulated device (contracts/loop/device_faults.py)."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import DeviceStatus
from mimics_app.contracts.loop.loop_ports import DATA_AGE, DATA_LENGTH
from mimics_app.contracts.loop.spoiling import Spoiling

__all__ = ["KIND", "ORDERS", "OTHER", "PLACE", "SPOILING_LENGTH", "VALUE", "is_deaf", "spoil"]

ORDERS, KIND, PLACE, OTHER, VALUE = 0, 1, 2, 3, 4
"""Places of what the main thread writes: number of orders, written last; `Spoiling`, its two indices in the data, and
its value."""
_TAKEN, _SINCE, _KEPT, _LATE = 5, 6, 7, 8
"""Places of what the loop writes: number of the order in force, ticks since it began, a value kept, late data."""

_LATE_TICKS = 15
SPOILING_LENGTH = _LATE + _LATE_TICKS * DATA_LENGTH

_FRESH, _NO_DATA, _FAULT = int(DeviceStatus.FRESH), int(DeviceStatus.NO_DATA), int(DeviceStatus.FAULT)

_MIX, _BITS, _HALF = 0x45D9F3B, 0xFFFFFFFF, 16
"""Factor, mask and half the length of a hash of the tick, which draws what is damaged."""


@kernel
def _is_damaged(tick: int) -> bool:
    """Whether the data of a tick arrive damaged: of half of the ticks, without a pattern."""
    mixed = (tick * _MIX) & _BITS
    mixed = ((mixed ^ (mixed >> _HALF)) * _MIX) & _BITS
    return (mixed >> _HALF) & 1 == 1


@kernel
def is_deaf(spoiling: Vec) -> bool:
    """Whether the device takes no command."""
    return spoiling[_TAKEN] != 0.0 and int(spoiling[KIND]) == Spoiling.REFUSE


@kernel
def _delayed(spoiling: Vec, data: Vec, since: int, dt: float) -> int:
    """Exchange the data for those of `_LATE_TICKS` ago."""
    first = _LATE + (since % _LATE_TICKS) * DATA_LENGTH
    for i in range(DATA_LENGTH):
        now, data[i] = data[i], spoiling[first + i]
        spoiling[first + i] = now
    data[DATA_AGE] += _LATE_TICKS * dt
    return _FRESH if since >= _LATE_TICKS else _NO_DATA


@kernel
def _changed(spoiling: Vec, kind: int, data: Vec, since: int) -> None:
    """Change a number of the data."""
    place, value = int(spoiling[PLACE]), spoiling[VALUE]
    if since == 0:
        spoiling[_KEPT] = data[place]
    if kind == Spoiling.SET:
        data[place] = value
    elif kind == Spoiling.ADD or (kind == Spoiling.ADD_ONCE and since == 0):
        data[place] += value
    elif kind == Spoiling.FREEZE:
        data[place] = spoiling[_KEPT]
    if spoiling[OTHER] >= 0.0:
        data[int(spoiling[OTHER])] = 0.0


@kernel
def spoil(spoiling: Vec, data: Vec, status: int, tick: int, dt: float) -> int:
    """Spoil the data that the device gave in this tick; return its status.

    Args:
        spoiling: Order and state of the fault, shape [SPOILING_LENGTH]; an order counts from the tick that sees it.
        data: Data of the device, changed.
        status: Status of its `read`.
        tick: Number of the tick.
        dt: Its length [s].
    """
    if spoiling[ORDERS] != spoiling[_TAKEN]:
        spoiling[_TAKEN] = spoiling[ORDERS]
        spoiling[_SINCE] = 0.0
    kind, since = int(spoiling[KIND]), int(spoiling[_SINCE])
    spoiling[_SINCE] += 1.0
    if status != _FRESH:
        return status
    if kind == Spoiling.DROP or (kind == Spoiling.DROP_SOME and _is_damaged(tick)):
        return _NO_DATA
    if kind == Spoiling.REPORT:
        return _FAULT
    if kind == Spoiling.DELAY:
        return _delayed(spoiling, data, since, dt)
    _changed(spoiling, kind, data, since)
    return status
