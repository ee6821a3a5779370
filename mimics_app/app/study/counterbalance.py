"""Orders of conditions: fixed, shuffled, by a Latin square, by a balanced Latin square.

The balanced square is that of E. J. Williams, "Experimental designs balanced for the estimation of residual effects of
treatments", Australian Journal of Scientific Research A 2 (1949) 149-168: for an even number of conditions each follows
each other one equally often in the rows of one square; an odd number needs its mirror image as well.
"""

from __future__ import annotations

import random
from typing import Literal, get_args

__all__ = ["ORDERS", "Order", "balanced_square", "latin_square", "order_of"]

Order = Literal["fixed", "shuffled", "latin", "balanced"]
ORDERS: tuple[Order, ...] = get_args(Order)


def order_of(order: Order, conditions: int, row: int, seed: int) -> list[int]:
    """Return the order of conditions, as their indices.

    Args:
        order: How it is found.
        conditions: Number of conditions.
        row: Row of the square, that is the number of the participant, 0 first; beyond the square it begins again.
        seed: Seed of the participant, for "shuffled".
    """
    if order == "fixed":
        return list(range(conditions))
    if order == "shuffled":
        return random.Random(seed).sample(range(conditions), conditions)
    square = latin_square(conditions) if order == "latin" else balanced_square(conditions)
    return square[row % len(square)]


def latin_square(conditions: int) -> list[list[int]]:
    """Return a cyclic Latin square: each condition is once in each row and each column, shape [n, n]."""
    return [[(row + place) % conditions for place in range(conditions)] for row in range(conditions)]


def balanced_square(conditions: int) -> list[list[int]]:
    """Return a balanced Latin square: [n, n] for an even number of conditions, [2 n, n] for an odd one."""
    first = [(step + 1) // 2 if step % 2 else (conditions - step // 2) % conditions for step in range(conditions)]
    rows = [[(row + place) % conditions for place in first] for row in range(conditions)]
    return rows if conditions % 2 == 0 else rows + [row[::-1] for row in rows]
