"""Which technique draws a material: the first along its chain of fallbacks that driver and profile can have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mimics_app.contracts.errors import nearest
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities
from mimics_app.world.materials.technique import Profile, TechniqueSpec

__all__ = ["SAFE", "Choice", "choose_technique", "technique_chain"]

SAFE = "unlit"
"""Drawn where a whole chain fails."""

_STANDS_IN = "lit"
"""Drawn instead of a technique nobody knows."""


@dataclass(frozen=True)
class Choice:
    """What draws a material.

    Attributes:
        name: Of the technique.
        spec: The technique.
        why: Why it is not the one that was requested, "" where it is.
        fault: True where that is a mistake and not a matter of driver or profile.
    """

    name: str
    spec: TechniqueSpec
    why: str = ""
    fault: bool = False


def choose_technique(
    wanted: str,
    known: Mapping[str, TechniqueSpec],
    has: Capabilities,
    profile: Profile,
    broken: Mapping[str, str] | None = None,
) -> Choice:
    """Go along the chain of fallbacks.

    Args:
        wanted: What the material requests.
        known: Techniques by name; has to have "lit" and "unlit".
        has: What the driver can do.
        profile: What it is drawn for.
        broken: Techniques whose shaders failed, with the reason.
    """
    broken = broken or {}
    if wanted not in known:
        why = f'no technique "{wanted}"; {nearest(wanted, known)}'
        instead = choose_technique(_STANDS_IN, known, has, profile, broken)
        return Choice(instead.name, instead.spec, f'{why}; drawn as "{instead.name}"', fault=True)
    reasons: list[str] = []
    for name in technique_chain(wanted, known):
        spec = known[name]
        reason = _refusal(name, spec, has, profile, broken)
        if not reason:
            why = f'"{wanted}" drawn as "{name}": {", ".join(reasons)}' if reasons else ""
            return Choice(name, spec, why, fault=wanted in broken)
        reasons.append(f"{name} {reason}")
    why = f'"{wanted}" drawn as "{SAFE}": {", ".join(reasons)}'
    return Choice(SAFE, known[SAFE], why, fault=any(name in broken for name in technique_chain(wanted, known)))


def technique_chain(wanted: str, known: Mapping[str, TechniqueSpec]) -> list[str]:
    """A technique and its fallbacks in order, each once, those that are not known left out."""
    chain: list[str] = []
    name: str | None = wanted
    while name is not None and name in known and name not in chain:
        chain.append(name)
        name = known[name].fallback
    return chain


def _refusal(name: str, spec: TechniqueSpec, has: Capabilities, profile: Profile, broken: Mapping[str, str]) -> str:
    """Why a technique cannot be had, "" where it can."""
    if name in broken:
        return broken[name]
    if not spec.passes:
        return "has no pass"
    if missing := has.missing(spec.needs):
        return f"needs {' and '.join(missing)}"
    return "" if profile in spec.profiles else f"is not for {profile}"
