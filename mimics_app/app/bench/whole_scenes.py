"""Whole scenes as points of a chart: cost and error of a tick and of a frame under each plan.

A scene has two groups, "tick of NAME" and "frame of NAME". Their methods are the plans of the profiles and, from each
of these, every change of a single method that the planner may choose. The costs are not sums over parts: the simulated
person plays the scene, its frames are drawn, and both are timed as a whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import get_args

from mimics_app.app.bench.whole_play import WholePlay
from mimics_app.app.picture.methods import PICTURE_GROUPS
from mimics_app.app.planner.plan import Plan, load_table, plan_scene
from mimics_app.app.planner.uses import uses
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.settings import Profile
from mimics_app.contracts.arrays import U1
from mimics_app.contracts.ports.methods import Group, Method, Registry, Settings
from mimics_app.contracts.system.resources import root
from mimics_app.lab.probe import reference_us
from mimics_app.lab.visual.probe import differing_pixels

__all__ = ["GROUPS", "register_whole", "variants"]

SCENES = ("wavy_tunnel", "pick_and_place", "examples/tower")
"""One scene each of a tunnel, a carried object, and components alone."""

TICK, FRAME = "tick of ", "frame of "

GROUPS = {f"{kind}{Path(scene).name.replace('_', ' ')}": (kind, scene) for kind in (TICK, FRAME) for scene in SCENES}
"""Kind (TICK or FRAME) and scene of each group."""

_TICK_GROUPS = ("tunnel projection", "admittance form", "contact law", "colliding bodies", "resting bodies")
"""Groups of methods that a tick runs."""

_REFERENCE: Profile = "study"
"""Profile of the reference plan, the most accurate one."""

_FRAMES = 300
"""Number of frames played while the person acts."""

_LEVEL = 1
"""Difference up to which a pixel counts as equal [levels of 255]."""

Variant = tuple[Profile, Mapping[str, Settings]]
"""Profile of the plan, and changed settings by group."""


def register_whole(registry: Registry, group: str) -> None:
    """Register a group of `GROUPS` with its plans as methods.

    Raises:
        SceneError: The scene is faulty.
    """
    kind, scene = GROUPS[group]
    unit, words = ("N", "false force on the same hand") if kind == TICK else ("share of pixels", "pixels that differ")
    what = f"one {kind}{scene} as a whole, played by the simulated person; error: {words} from a study's plan"
    why = "a session's profile is `training` unless its scene or its operator names another"
    registry.describe(Group(group, what, unit, "", reference_us, why_default=why))
    cost, error = (_tick_us, _false_force) if kind == TICK else (_frame_us, _pixels)
    for name, variant in variants(scene, _TICK_GROUPS if kind == TICK else PICTURE_GROUPS).items():
        registry.register(
            Method(
                group=group,
                name=name,
                source="the plan of a profile" if name == variant[0] else "that plan with one method changed",
                cost=partial(cost, scene, name),
                error=partial(error, scene, name),
                unit=unit,
                valid_range=f"{scene}, seed 1, its first {_FRAMES / 60:g} s of play",
                settings={"profile": variant[0], **variant[1]},
                default=name == "training",
            )
        )


@cache
def _known(scene: str, groups: tuple[str, ...]) -> dict[str, Variant]:
    found: dict[str, Variant] = {}
    seen: list[dict[str, Settings]] = []
    for profile in get_args(Profile):
        plan = _plan(scene, profile)
        for name, changes in [(profile, {}), *_single_changes(scene, plan, groups)]:
            runs = {group: {**plan.settings, **changes}.get(group, {}) for group in groups}
            if runs not in seen or not changes:
                seen.append(runs)
                found[name] = (profile, changes)
    return found


def variants(scene: str, groups: tuple[str, ...]) -> dict[str, Variant]:
    """Return the plans of the profiles, and each with one changed method that the planner may choose, by name.

    Plans that run the same methods as an earlier one are left out, except for those of the profiles.
    """
    return dict(_known(scene, groups))


def _single_changes(scene: str, plan: Plan, groups: tuple[str, ...]) -> Iterator[tuple[str, dict[str, Settings]]]:
    loaded = load_checked_scene(_file(scene))
    for choice in plan.choices:
        if choice.group not in groups or uses()[choice.group].named(loaded) is not None:
            continue
        for row in plan.table.groups[choice.group]:
            if row.method != choice.taken.method and uses()[choice.group].allowed(loaded, row.settings):
                yield f"{plan.profile}, {choice.group}: {row.method}", {choice.group: row.settings}


def _file(scene: str) -> Path:
    return root() / "scenes" / f"{scene}.json"


@cache
def _plan(scene: str, profile: Profile) -> Plan:
    return plan_scene(load_checked_scene(_file(scene)), profile, load_table()[0])


def _changed(scene: str, variant: Variant) -> Plan:
    """Return the plan of a variant."""
    profile, changes = variant
    plan = _plan(scene, profile)
    choices = (
        replace(choice, taken=replace(choice.taken, settings=changes.get(choice.group, choice.taken.settings)))
        for choice in plan.choices
    )
    return replace(plan, choices=tuple(choices))


def _play(scene: str, variant: Variant) -> WholePlay:
    return WholePlay(load_checked_scene(_file(scene)), _changed(scene, variant), _FRAMES)


def _tick_us(scene: str, name: str) -> float:
    with _play(scene, _known(scene, _TICK_GROUPS)[name]) as play:
        return play.tick_us()


@cache
def _reference(scene: str) -> WholePlay:
    """Return the play of the reference plan, which stays open as long as this process measures."""
    return _play(scene, (_REFERENCE, {}))


def _false_force(scene: str, name: str) -> float:
    """Return the RMS difference of the force on the user to that of the reference plan, for the same motion [N]."""
    with _play(scene, _known(scene, _TICK_GROUPS)[name]) as changed:
        return _reference(scene).force_apart(changed)


def _drawn(scene: str, name: str) -> tuple[float, U1]:
    return _reference(scene).draw(_changed(scene, _known(scene, PICTURE_GROUPS)[name]))


def _frame_us(scene: str, name: str) -> float:
    return _drawn(scene, name)[0]


@cache
def _reference_picture(scene: str) -> U1:
    return _drawn(scene, _REFERENCE)[1]


def _pixels(scene: str, name: str) -> float:
    return differing_pixels(_drawn(scene, name)[1], _reference_picture(scene), _LEVEL)
