"""Energy tank: what active forces give to the user must have been in it (Ferraguti et al. 2013, there for one arm).

Assistance, effects, held things and bodies that move may give energy that the user never put in. Each tick takes the
exact work of their held forces out of the tank, or puts it in; a tank that runs low scales them down smoothly.
"""

from __future__ import annotations

from mimics_app.contracts.kernel import kernel

__all__ = ["payable_share", "settle_account"]

_EMPTYING_TIME = 0.1
"""No power may empty the tank faster than this, so that forces fade instead of breaking off [s]."""


@kernel
def settle_account(level: float, given: float, inflow: float, size: float, dt: float) -> float:
    """Level of the tank [J] after a tick.

    Args:
        level: Before it [J].
        given: Work of the active forces on the user [J]; below 0 the user put it in.
        inflow: Refill [W].
        size: Most it holds [J].
        dt: Tick [s].
    """
    return min(size, max(0.0, level - given + inflow * dt))


@kernel
def payable_share(level: float, power: float, inflow: float) -> float:
    """Share 0-1 of the active forces that can be paid, where all of them would give `power` [W] to the user.

    The refill can always be given, and the level within the emptying time; forces that take power are free.
    """
    allowed = inflow + level / _EMPTYING_TIME
    return allowed / power if power > allowed else 1.0
