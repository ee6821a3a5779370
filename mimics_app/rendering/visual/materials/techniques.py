"""Choice of a material's technique: the first of its chain of fallbacks that driver and profile support."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mimics_app.contracts.errors import nearest
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities
from mimics_app.world.content.materials.technique import Profile, TechniqueSpec

__all__ = ["SAFE", "ChosenTechnique", "choose_technique", "technique_chain"]

SAFE = "unlit"
"""Technique in use where a whole chain fails."""

_DEFAULT = "lit"
"""Replacement of an unknown technique."""


@dataclass(frozen=True)
class ChosenTechnique:
    """Technique chosen for a material.

    Attributes:
        name: Name of the technique.
        spec: The technique.
        why: Why it is not the requested one, "" where it is.
        fault: True where the cause is an error, not a limit of driver or profile.
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
) -> ChosenTechnique:
    """Choose the first usable technique of a chain of fallbacks.

    Args:
        wanted: Technique that the material requests.
        known: Techniques by name; must contain "lit" and "unlit".
        has: Capabilities of the driver.
        profile: Purpose of the picture.
        broken: Techniques whose shaders failed, with the reason.
    """
    broken = broken or {}
    if wanted not in known:
        why = f'no technique "{wanted}"; {nearest(wanted, known)}'
        instead = choose_technique(_DEFAULT, known, has, profile, broken)
        return ChosenTechnique(instead.name, instead.spec, f'{why}; drawn as "{instead.name}"', fault=True)
    reasons: list[str] = []
    for name in technique_chain(wanted, known):
        spec = known[name]
        reason = _refusal(name, spec, has, profile, broken)
        if not reason:
            why = f'"{wanted}" drawn as "{name}": {", ".join(reasons)}' if reasons else ""
            return ChosenTechnique(name, spec, why, fault=wanted in broken)
        reasons.append(f"{name} {reason}")
    why = f'"{wanted}" drawn as "{SAFE}": {", ".join(reasons)}'
    return ChosenTechnique(SAFE, known[SAFE], why, fault=any(name in broken for name in technique_chain(wanted, known)))


def technique_chain(wanted: str, known: Mapping[str, TechniqueSpec]) -> list[str]:
    """Return a technique and its fallbacks in order, each once, up to the first unknown one."""
    chain: list[str] = []
    name: str | None = wanted
    while name is not None and name in known and name not in chain:
        chain.append(name)
        name = known[name].fallback
    return chain


def _refusal(name: str, spec: TechniqueSpec, has: Capabilities, profile: Profile, broken: Mapping[str, str]) -> str:
    """Return why a technique cannot be used, "" where it can."""
    if name in broken:
        return broken[name]
    if not spec.passes:
        return "has no pass"
    if missing := has.missing(spec.needs):
        return f"needs {' and '.join(missing)}"
    return "" if profile in spec.profiles else f"is not for {profile}"
