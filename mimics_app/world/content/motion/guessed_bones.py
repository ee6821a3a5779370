"""Bones of a person guessed from where the joints are: two legs, two arms, a spine, and the head on top."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.motion.rig import Rig

__all__ = ["guess_by_place"]


_LIMB = {"Arm": ("UpperArm", "LowerArm", "Hand"), "Leg": ("UpperLeg", "LowerLeg", "Foot")}
_SPINE = ("spine", "chest", "upperChest")

_MIRRORED = 0.15
"""Share of a person's height by which joints of the two sides may differ from mirror images."""

_ASIDE = 0.01
"""Share of that height by which they lie beside the middle."""

_LEAST_HEIGHT = 1e-3
"""Height below which there is no person [m]."""


def guess_by_place(rig: Rig, slots: dict[str, int], names: dict[str, str], guesses: list[str]) -> None:
    """Add the bones that are missing, where the joints are those of a person who stands upright.

    Args:
        rig: Nodes of the model.
        slots: Slots of the bones found so far; completed.
        names: Their names in the model; completed.
        guesses: Report of guesses; completed.
    """
    tree = _Tree(rig)
    for bone, slot in tree.person().items():
        if bone not in slots and slot not in slots.values():
            slots[bone], names[bone] = slot, rig.names[slot]
            guesses.append(f'{bone}: "{rig.names[slot]}", by its place')


class _Tree:
    """The joints of a model, and ways through them."""

    def __init__(self, rig: Rig) -> None:
        self._rig, self._places = rig, rig.rest_places()
        below = {int(above) for above in rig.parents}
        self._ends = [slot for slot in range(len(rig.names)) if slot not in below and int(rig.parents[slot]) >= 0]

    def person(self) -> dict[str, int]:
        """Return the bones of a person; empty where the joints are not those of one."""
        pairs = self._mirrored_ends()
        if len(pairs) < 2:
            return {}
        feet = min(pairs, key=lambda pair: float(self._places[list(pair), 1].mean()))
        hips = self._meeting(*feet)
        others = [pair for pair in pairs if not set(pair) & set(feet) and self._meeting(*pair) != hips]
        others = [pair for pair in others if hips in self._up(self._meeting(*pair))]
        if not others:
            return {}
        hands = max(others, key=lambda pair: float(np.ptp(self._places[list(pair), 0])))
        chest = self._meeting(*hands)
        found = {"hips": hips, **self._spine(hips, chest)}
        for limb, ends in (("Arm", hands), ("Leg", feet)):
            for end in ends:
                way = self._way(chest if limb == "Arm" else hips, end)
                side = "left" if self._places[end, 0] > self._places[hips, 0] else "right"
                found |= {f"{side}{bone}": slot for bone, slot in self._limb(limb, way).items()}
        front = self._front(found)
        if front < 0.0:
            found = {_other(bone): slot for bone, slot in found.items()}
        return found

    def _mirrored_ends(self) -> list[tuple[int, int]]:
        """Return pairs of end joints that are mirror images of each other across the middle."""
        places, ends = self._places, self._ends
        if len(ends) < 4:
            return []
        height = float(np.ptp(places[ends, 1]))
        if height < _LEAST_HEIGHT:
            return []
        middle = 0.5 * float(places[ends, 0].min() + places[ends, 0].max())
        pairs = []
        for a, b in itertools.combinations(ends, 2):
            image = places[b] * (-1.0, 1.0, 1.0) + (2.0 * middle, 0.0, 0.0)
            aside = (places[a, 0] - middle) * (middle - places[b, 0])
            if aside > (_ASIDE * height) ** 2 and float(np.linalg.norm(places[a] - image)) < _MIRRORED * height:
                pairs.append((a, b))
        return pairs

    def _up(self, slot: int) -> list[int]:
        """Return a slot and all above it."""
        way = list[int]()
        while slot >= 0:
            way.append(slot)
            slot = int(self._rig.parents[slot])
        return way

    def _meeting(self, a: int, b: int) -> int:
        """Return the lowest slot in the tree above two others; -1 for none."""
        above = set(self._up(a))
        return next((slot for slot in self._up(b) if slot in above), -1)

    def _way(self, above: int, end: int) -> list[int]:
        """Return the slots from below one down to another."""
        way = self._up(end)
        return way[: way.index(above)][::-1] if above in way else []

    def _spine(self, hips: int, chest: int) -> dict[str, int]:
        """Return vertebrae, neck and head: what lies on the way to the highest end above the chest."""
        tops = [end for end in self._ends if chest in self._up(end)]
        top = max(tops, key=lambda end: float(self._places[end, 1] - abs(self._places[end, 0] - self._places[hips, 0])))
        between = self._way(hips, chest)
        found = dict(zip(_SPINE, between if len(between) <= 3 else (between[0], between[1], between[-1]), strict=False))
        rest = self._way(chest, top)
        if len(rest) == 1:
            found["head"] = rest[0]
        elif rest:
            found["neck"], found["head"] = rest[0], rest[1]
        return found

    def _limb(self, limb: str, way: Sequence[int]) -> dict[str, int]:
        """Return the three joints in a row with the longest bones between them, and collar bone or toes."""
        if len(way) < 3:
            return {}
        bones = np.linalg.norm(np.diff(self._places[list(way)], axis=0), axis=1)
        first = int(np.argmax(np.minimum(bones[1:], bones[:-1])))
        found = dict(zip(_LIMB[limb], way[first : first + 3], strict=True))
        if limb == "Arm" and first > 0:
            found["Shoulder"] = way[first - 1]
        if limb == "Leg" and first + 3 < len(way):
            found["Toes"] = way[first + 3]
        return found

    def _front(self, found: dict[str, int]) -> float:
        """Return how far the toes lie ahead of the ankles along +z [m]; 0 without toes."""
        ahead = 0.0
        for side in ("left", "right"):
            if f"{side}Toes" in found and f"{side}Foot" in found:
                step: F8 = self._places[found[f"{side}Toes"]] - self._places[found[f"{side}Foot"]]
                ahead += float(step[2])
        return ahead


def _other(bone: str) -> str:
    for side, other in (("left", "right"), ("right", "left")):
        if bone.startswith(side):
            return other + bone.removeprefix(side)
    return bone
