"""Bounded number types of the structs of a task, beside those of all components."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.world.components.bounds import Figure

__all__ = ["Steps", "Table", "Tolerance", "Values"]

Steps = Annotated[float, Meta(ge=0.0, le=1e12)]
"""A difference of a parameter, in a unit that the file chooses."""

Tolerance = Annotated[float, Meta(gt=0.0, le=100.0)]
"""Tolerance of a joint [m, rad]."""

Values = Annotated[dict[str, Figure], Meta(max_length=1000)]
"""Values of parameters by name."""

Table = Annotated[list[Figure | str], Meta(max_length=10_000)]
