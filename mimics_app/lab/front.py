"""The Pareto front: what cannot be had cheaper without a larger error, nor more accurate without a larger cost."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["pareto_front"]


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the (cost, error) points that none other beats, cheapest first.

    A point that is not finite is never on it; of equal points the first one is.
    """
    finite = [i for i, point in enumerate(points) if all(math.isfinite(value) for value in point)]
    front: list[int] = []
    lowest = math.inf
    for i in sorted(finite, key=lambda i: (points[i], i)):
        if points[i][1] < lowest:
            front.append(i)
            lowest = points[i][1]
    return front
