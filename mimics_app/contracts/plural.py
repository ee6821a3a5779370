"""Counts with nouns in singular and plural: "1 mesh", "2 meshes"."""

from __future__ import annotations

__all__ = ["counted", "singular"]


def singular(plural: str) -> str:
    """Return the singular of a regular plural: mesh of meshes, entity of entities, node of nodes."""
    if plural.endswith("ies"):
        return f"{plural[:-3]}y"
    return plural[:-2] if plural.endswith(("shes", "ches", "xes", "sses")) else plural.removesuffix("s")


def counted(number: int, plural: str) -> str:
    """Return a number with its noun, in the singular for 1."""
    return f"{number} {singular(plural) if number == 1 else plural}"
