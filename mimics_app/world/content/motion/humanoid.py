"""Humanoid bones by the names of VRM 1.0, mapped from the bone names of other skeletons.

The table of a VRM file is taken as it is. Otherwise a name is split into side, part and number: the names of Mixamo,
Blender, Rigify, Unreal, 3ds Max Biped, MotionBuilder, Maya, Character Creator, Daz and VRM 0 are known. Bones without a
known name are guessed from the hierarchy and from their places, and every guess is reported.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from mimics_app.contracts.system.table_file import read_table_file
from mimics_app.world.content.motion.guessed_bones import guess_by_place
from mimics_app.world.content.motion.rig import Rig

__all__ = ["BONES", "NEEDED", "HumanoidMap", "find_humanoid", "report_lines"]

_CENTRE = ("hips", "spine", "chest", "upperChest", "neck", "head")
_ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")
_LEG = ("UpperLeg", "LowerLeg", "Foot", "Toes")
_SIDES = ("left", "right")

BONES: tuple[str, ...] = (
    *_CENTRE,
    *(f"{side}{part}" for side in _SIDES for part in (*_ARM, *_LEG)),
    *(f"{side}Eye" for side in _SIDES),
)
"""Bones that are mapped; fingers are not."""

NEEDED: tuple[str, ...] = (
    "hips",
    "spine",
    "head",
    *(f"{side}{part}" for side in _SIDES for part in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")),
)
"""Bones that a humanoid skeleton must have."""

_WORDS = read_table_file(Path(__file__).with_suffix(".json"), dict[str, tuple[str, ...]])
_PREFIX = re.compile(
    r"^(?:mixamorig\d*[:_]?|bip0?01[ _]?|def[-_]|org[-_]|j_(?:bip|sec|adj)_(?:c_)?|armature[|_/]|cc_base_"
    r"|character\d*_)",
    re.IGNORECASE,
)
_MIDDLE = re.compile(r"_M$")
"""What Maya's rigs append to bones of the middle."""
_NUMBERED = re.compile(r"^spine(?:\.?\d{3})?$")
"""Vertebrae of a Rigify skeleton."""
_SIDE = (
    re.compile(r"^(?P<side>left|right)[ _.-]?(?P<rest>.+)$", re.IGNORECASE),
    re.compile(r"^(?P<rest>.+?)[ _.-]?(?P<side>left|right)$", re.IGNORECASE),
    re.compile(r"^(?P<side>[LR])[ _.](?P<rest>.+)$", re.IGNORECASE),
    re.compile(r"^(?P<rest>.+)[ _.-](?P<side>[LR])(?:[ _.]?0*\d+)?$", re.IGNORECASE),
    re.compile(r"^(?P<side>[lr])(?P<rest>[A-Z].+)$"),
)


@dataclass(frozen=True, eq=False)
class HumanoidMap:
    """Map of the humanoid bones of a model.

    Attributes:
        slots: Slot of each mapped bone.
        names: Names of these bones in the model.
        guesses: Report of mappings that did not follow from a name, one line each.
        missing: Bones of `NEEDED` that the model lacks.
    """

    slots: dict[str, int] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    guesses: list[str] = field(default_factory=list)
    missing: tuple[str, ...] = ()

    @property
    def complete(self) -> bool:
        """True when no needed bone is missing."""
        return not self.missing

    def limb(self, limb: str) -> tuple[int, int, int]:
        """Return the slots of a limb: "left_arm", "right_leg" and so on.

        Raises:
            KeyError: one of its bones is missing.
        """
        side, _, part = limb.partition("_")
        bones = ("UpperArm", "LowerArm", "Hand") if part == "arm" else ("UpperLeg", "LowerLeg", "Foot")
        upper, lower, end = (self.slots[f"{side}{bone}"] for bone in bones)
        return upper, lower, end


def find_humanoid(rig: Rig) -> HumanoidMap:
    """Map the humanoid bones of a model: by its own table (VRM), by their names, then by their places."""
    found = HumanoidMap()
    for bone, slot in rig.bones.items():
        if bone in BONES:
            found.slots[bone], found.names[bone] = slot, rig.names[slot]
    if not found.slots:
        _find_by_name(rig, found)
        _choose_spine(rig, found)
        _guess(rig, found)
    if any(bone not in found.slots for bone in NEEDED):
        guess_by_place(rig, found.slots, found.names, found.guesses)
    missing = tuple(bone for bone in NEEDED if bone not in found.slots)
    return HumanoidMap(found.slots, found.names, found.guesses, missing)


def _find_by_name(rig: Rig, found: HumanoidMap) -> None:
    words = dict[str, dict[str, int]]()
    for slot, name in enumerate(rig.names):
        known = _bone_of(name)
        if known is not None:
            words.setdefault(known[0], {}).setdefault(known[1], slot)
    for side in _SIDES:
        _choose_shoulder(words, f"{side}Shoulder", f"{side}UpperArm", f"{side}LowerArm")
    if "hips" not in words:
        _choose_numbered_spine(rig, words)
    for bone, by_word in words.items():
        slot = min(by_word.values())
        found.slots[bone], found.names[bone] = slot, rig.names[slot]


def _choose_shoulder(words: dict[str, dict[str, int]], shoulder: str, upper: str, lower: str) -> None:
    """Where nothing is called an arm, what is called a shoulder is the upper arm; the collar bone is above it."""
    named = words.get(shoulder, {})
    if upper not in words and lower in words and "shoulder" in named:
        words[upper] = {"shoulder": named.pop("shoulder")}
        if not named:
            del words[shoulder]


def _choose_numbered_spine(rig: Rig, words: dict[str, dict[str, int]]) -> None:
    """Of vertebrae that are only numbered (Rigify) the first is the hips, the last ones are neck and head."""
    series = [slot for slot, name in enumerate(rig.names) if _NUMBERED.match(_PREFIX.sub("", name))]
    if len(series) < 3:
        return
    words["hips"] = {"": series[0]}
    for bone in _CENTRE[1:4]:
        words.pop(bone, None)
    if "head" not in words:
        words["head"] = {"": series[-1]}
        if len(series) > 4 and "neck" not in words:
            words["neck"] = {"": series[-2]}


def _bone_of(name: str) -> tuple[str, str] | None:
    """Return the bone of a name and the word for it; None for any other node."""
    bare = _PREFIX.sub("", name.rsplit(":", 1)[-1])
    if bare == "Root_M":
        return "hips", "root"
    bare = _MIDDLE.sub("", bare)
    side, rest = "", bare
    for pattern in _SIDE:
        match = pattern.match(bare)
        if match:
            side, rest = ("left" if match["side"][0] in "lL" else "right"), match["rest"]
            break
    word = re.sub(r"[ _.\-]", "", _PREFIX.sub("", rest)).lower()
    for part, words in _WORDS.items():
        if word in words and (part in _CENTRE) == (side == ""):
            return (part if not side else f"{side}{part}"), word
    return None


def _choose_spine(rig: Rig, found: HumanoidMap) -> None:
    """Assign the nodes between hips and neck by order, because files number vertebrae from either end."""
    top = found.slots.get("neck", found.slots.get("head", -1))
    hips = found.slots.get("hips", -1)
    if top < 0 or hips < 0:
        return
    between, at = list[int](), int(rig.parents[top])
    while at not in (-1, hips):
        between.insert(0, at)
        at = int(rig.parents[at])
    if at != hips or not between:
        return
    for bone in ("spine", "chest", "upperChest"):
        found.slots.pop(bone, None)
        found.names.pop(bone, None)
    chosen = between if len(between) <= 3 else [between[0], between[len(between) // 2], between[-1]]
    for bone, slot in zip(("spine", "chest", "upperChest"), chosen, strict=False):
        found.slots[bone], found.names[bone] = slot, rig.names[slot]
    if len(between) > 3:
        found.guesses.append(f"{len(between)} vertebrae: spine, chest and upperChest are the first, a middle, the last")


def _guess(rig: Rig, found: HumanoidMap) -> None:
    """Fill gaps in limbs from the chain between two known bones."""
    for side in _SIDES:
        for parts in (_ARM, _LEG):
            for before, wanted, after in zip(parts, parts[1:], parts[2:], strict=False):
                bones = [f"{side}{part}" for part in (before, wanted, after)]
                if bones[1] in found.slots or bones[0] not in found.slots or bones[2] not in found.slots:
                    continue
                at = int(rig.parents[found.slots[bones[2]]])
                if at not in (-1, found.slots[bones[0]]):
                    found.slots[bones[1]], found.names[bones[1]] = at, rig.names[at]
                    found.guesses.append(f'{bones[1]}: "{rig.names[at]}", which lies between {bones[0]} and {bones[2]}')


def report_lines(found: HumanoidMap, extra: Sequence[str] = ()) -> list[str]:
    """Return a report of mapped, guessed and missing bones, one line each."""
    lines = [f'{bone}: "{found.names[bone]}"' for bone in BONES if bone in found.names]
    lines += [f"guessed: {guess}" for guess in found.guesses]
    lines += [f"missing: {bone}" for bone in found.missing]
    return [*lines, *extra]
