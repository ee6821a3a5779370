"""Bodies that cast shadows."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.arrays import F8, I4

__all__ = ["Casters"]


@dataclass(frozen=True, eq=False)
class Casters:
    """Shadow casters, and the bounding spheres of those that a shadow map has to cover.

    Attributes:
        items: Numbers of items, int32 [n].
        centres: Centres of the spheres, world [m], float64 [m, 3].
        radii: Their radii [m], float64 [m].
    """

    items: I4
    centres: F8
    radii: F8

    def only(self, items: I4) -> Casters:
        """Return some of the casters in maps that cover all of them."""
        return Casters(items, self.centres, self.radii)
