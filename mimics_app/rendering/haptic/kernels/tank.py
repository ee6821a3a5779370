"""Energy tank: a budget for the energy that active forces give to the user (Ferraguti et al. 2013, there for one arm).

Assistance, effects, held and moving bodies may give energy that the user never put in. Each tick books the exact work
of their held forces; a tank that runs low scales them down smoothly.
"""

from __future__ import annotations

from mimics_app.contracts.kernel import kernel

__all__ = ["payable_share", "settle_account"]

_EMPTYING_TIME = 0.1
"""Shortest time in which active forces may empty the tank [s], so that they fade instead of breaking off."""


@kernel
def settle_account(level: float, given: float, inflow: float, size: float, dt: float) -> float:
    """Level of the tank [J] after a tick.

    Args:
        level: Level before the tick [J].
        given: Work of the active forces on the user [J]; below 0: work of the user on them.
        inflow: Refill [W].
        size: Capacity [J].
        dt: Tick [s].
    """
    return min(size, max(0.0, level - given + inflow * dt))


@kernel
def payable_share(level: float, power: float, inflow: float) -> float:
    """Share 0-1 of the active forces that can be paid, where all of them would give `power` [W] to the user.

    Available are the refill and the level within the emptying time; forces that absorb power are free.
    """
    allowed = inflow + level / _EMPTYING_TIME
    return allowed / power if power > allowed else 1.0
