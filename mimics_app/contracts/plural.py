"""Numbers of things in words: "1 mesh", "2 meshes"."""

from __future__ import annotations

__all__ = ["counted", "singular"]


def singular(plural: str) -> str:
    """One of what a plural in -s, -es after a hiss, or -ies names: meshes, mesh; entities, entity; nodes, node."""
    if plural.endswith("ies"):
        return f"{plural[:-3]}y"
    return plural[:-2] if plural.endswith(("shes", "ches", "xes", "sses")) else plural.removesuffix("s")


def counted(number: int, plural: str) -> str:
    """A number and what is counted, in the singular for 1."""
    return f"{number} {singular(plural) if number == 1 else plural}"
