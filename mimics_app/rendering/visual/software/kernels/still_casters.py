"""Casters of a shadow map that are drawn over the kept depths of others."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import I4, I8, U1

__all__ = ["find_moving"]

_CASTS, _KEPT = 1, 2


@kernel
def find_moving(casters: I4, kept: I4, moved_at: I8, kept_in: int, last: int, marks: U1, moving: I4) -> int:
    """List the casters that are not kept; return their number, -1 where the kept ones do not hold any more.

    They hold while all of them cast and have not moved since, and each of the others has moved lately.

    Args:
        casters: Numbers of the items that cast, [n].
        kept: Numbers of the items whose depths are kept, [k].
        moved_at: Frame in which each item last moved, [items].
        kept_in: Frame in which the depths were drawn.
        last: Frame since which an item must have moved, so that it does not count as static.
        marks: Scratch, [items].
        moving: Written, [>= n].
    """
    marks[:] = 0
    for item in casters:
        marks[item] = _CASTS
    for item in kept:
        if moved_at[item] > kept_in or not marks[item]:
            return -1
        marks[item] = _KEPT
    count = 0
    for item in casters:
        if marks[item] == _KEPT:
            continue
        if moved_at[item] <= last:
            return -1
        moving[count] = item
        count += 1
    return count
