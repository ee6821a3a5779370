"""Values with which a run would begin, each with its origin: default, profile, scene, command line or device."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, cast, get_type_hints

import msgspec

from mimics_app.app.scenes.fitted_scene import FITTED
from mimics_app.app.session.preparation import SessionParts
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.ceilings import CEILINGS
from mimics_app.app.touch.device_fit import device_values
from mimics_app.rendering.haptic.scene_block import safety_of
from mimics_app.world.components.robot import Safety
from mimics_app.world.components.systems import Tolerances
from mimics_app.world.components.tolerance_units import UNIT_OF_FIELD
from mimics_app.world.files.scene.scene import Scene

__all__ = ["EffectiveSetting", "effective_settings"]

_DEFAULT = "default"
_CEILING = "ceiling of this machine, see mimics limits"

_OPTION_UNITS = {"seconds": "s", "size": "px", "baseline_s": "s"}
"""Units of the options that have one, by field of `RunSettings`."""


@dataclass(frozen=True, slots=True)
class EffectiveSetting:
    """One value.

    Attributes:
        section: "run": an option of `mimics run`; "fitted": fitted to the person; "safety": a limit or threshold of the
            haptic loop; "tolerances": an error that the planner accepts.
        name: As it is written in the section.
        value: In `unit`.
        unit: "" for a number without unit, a word or a truth value.
        origin: "default", "profile NAME", "command line", "participant CODE", "device NAME", the ceiling of this
            machine, or the place in a scene file as file#/json/pointer.
        meaning: Description for a person.
    """

    section: str
    name: str
    value: bool | float | str | None
    unit: str
    origin: str
    meaning: str


def effective_settings(
    parts: SessionParts, options: Mapping[str, str], kept: Collection[str] = ()
) -> list[EffectiveSetting]:
    """Return all values of a prepared run; the limits are read from the parameter block that the loop would get.

    Args:
        parts: The prepared run; its parameters are fitted to the device here.
        options: Meaning of each option of `mimics run`, by the name of its field in `RunSettings`.
        kept: Fields of those that are as kept with the participant.
    """
    return [*_options(parts.settings, options, kept), *_fitted(parts), *_limits(parts), *_tolerances(parts)]


def _options(settings: RunSettings, meanings: Mapping[str, str], kept: Collection[str]) -> Iterator[EffectiveSetting]:
    defaults = RunSettings(settings.scene)
    for name in (field.name for field in fields(settings) if field.name in meanings):
        value = getattr(settings, name)
        stated = f"participant {settings.participant}" if name in kept else "command line"
        origin = _DEFAULT if value == getattr(defaults, name) and name != "scene" else stated
        meaning = meanings[name]
        yield EffectiveSetting("run", name, _plain(value), _OPTION_UNITS.get(name, ""), origin, meaning)


def _fitted(parts: SessionParts) -> Iterator[EffectiveSetting]:
    """Numbers that are fitted to the person; without a calibration there are none."""
    origin = f"calibration {parts.fit.source}"
    for change in parts.scene.document.get(FITTED, ()):
        meaning = f"{change['meaning']}; the scene has {change['before']:g}"
        yield EffectiveSetting("fitted", change["name"], change["value"], change["unit"], origin, meaning)


def _limits(parts: SessionParts) -> Iterator[EffectiveSetting]:
    """Limits and thresholds, with the origin of those that differ from the component's default."""
    parts.parameter_store.fit(device_values(parts.plugin, parts.scene, parts.parameter_store.block))
    block, device = parts.parameter_store.block, f"device {parts.robot.device}"
    scene = parts.scene
    _, stated, pointer = next(iter(scene.components(Safety)), ("", Safety(), ""))
    written = _written_at(scene, pointer) if pointer else {}
    for name, value in msgspec.structs.asdict(safety_of(block)).items():
        origin = scene.place(f"{pointer}/{name}") if name in written else _DEFAULT
        origin = device if value != getattr(stated, name) else origin
        origin = _CEILING if name in parts.held.names else origin
        yield EffectiveSetting(
            "safety", name, value, CEILINGS[name].unit if name in CEILINGS else "", origin, _description(name)
        )
    latches = "Whether late ticks latch SAFE_STOP; of a simulated device they hold it"
    yield EffectiveSetting("safety", "late_latches", bool(block["late_latches"][0]), "", device, latches)


def _written_at(scene: Scene, pointer: str) -> Mapping[str, object]:
    """Return what the files of a scene state at a pointer of its resolved document."""
    value: Any = scene.document
    for key in pointer.split("/")[1:]:
        value = value[int(key) if isinstance(value, list) else key]
    return cast("Mapping[str, object]", value)


def _description(name: str) -> str:
    """Return the description of a field of `Safety`, with its unit in brackets."""
    annotation = get_type_hints(Safety, include_extras=True)[name]
    return str(annotation.__metadata__[-1].description)


def _tolerances(parts: SessionParts) -> Iterator[EffectiveSetting]:
    stated = parts.scene.system(Tolerances) or Tolerances()
    for name, unit in UNIT_OF_FIELD.items():
        given = getattr(stated, name)
        origin = f"profile {parts.plan.profile}" if given is None else parts.scene.place(f"/systems/tolerances/{name}")
        yield EffectiveSetting("tolerances", name, parts.plan.tolerances[name], unit, origin, "Largest accepted error")


def _plain(value: object) -> bool | float | str | None:
    if isinstance(value, tuple):
        return "x".join(str(number) for number in value)
    if isinstance(value, Path):
        return str(value)
    assert value is None or isinstance(value, bool | int | float | str)
    return value
