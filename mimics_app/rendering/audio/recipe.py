"""Port of synthesised sounds: a recipe, and what it is asked for.

Built in are the recipes of the modules in `rendering/audio/recipes`; those of installed packages are entry points of
the group `mimics_app.sound_recipes`. A scene names a recipe by `sound.synth`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from mimics_app.contracts.arrays import F4
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginGroup
from mimics_app.rendering.audio import recipes
from mimics_app.rendering.audio.settings import AROUSAL

__all__ = ["PLUGINS", "Modes", "Recipe", "Variant", "built_in_recipes", "find_recipe", "recipe_names"]

Modes = tuple[tuple[float, float, float], ...]
"""Frequency [Hz], T60 [s] and weight of each mode of a struck object."""


@dataclass(frozen=True, slots=True)
class Variant:
    """Which of its sounds a recipe makes.

    Attributes:
        speed: Impact speed [m/s], for a recipe that is `by_speed`.
        take: Number of the take, from 0.
        arousal: How much a crowd shouts and claps, 0 to 1.
    """

    speed: float = 0.3
    take: int = 0
    arousal: float = AROUSAL


@dataclass(frozen=True, slots=True)
class Recipe:
    """A synthesised sound.

    Attributes:
        synthesise: Returns the samples of a variant at a rate [1/s]: float32 in [-1, 1], shape [n], one channel,
            without a constant part. The same arguments give the same samples.
        takes: Number of takes; they alternate, so that no sound is played twice in a row.
        by_speed: True for the sound of an impact, which depends on its speed.
        loop: True for samples whose end continues at their beginning.
        modes: Modes of an object that the contact force excites while it is touched; (): it sounds as synthesised.
        parameters: Parameters of a scene's sound that it takes besides the pitch.
    """

    synthesise: Callable[[Variant, int], F4]
    takes: int = 1
    by_speed: bool = False
    loop: bool = False
    modes: Modes = ()
    parameters: frozenset[str] = frozenset()


def _fault_of(name: str, loaded: object) -> str:
    if name in built_in_recipes():
        return "has the name of a built-in recipe"
    return "" if isinstance(loaded, Recipe) else f"is not a {Recipe.__module__}.{Recipe.__name__}"


PLUGINS = PluginGroup("mimics_app.sound_recipes", _fault_of)


@cache
def built_in_recipes() -> dict[str, Recipe]:
    """Return the built-in recipes by name: those of all modules in `recipes`."""
    tables = (load_member(recipes, module, "RECIPES", dict) for module in member_names(recipes))
    return {name: recipe for table in tables for name, recipe in table.items()}


def recipe_names() -> list[str]:
    """Return the names of all recipes: built-in first, then installed ones."""
    return [*built_in_recipes(), *sorted(set(PLUGINS.names()) - set(built_in_recipes()))]


def find_recipe(name: str) -> Recipe | None:
    """Return a recipe; None: there is none of this name.

    Raises:
        PluginError: Its plug-in cannot be loaded.
    """
    if name in built_in_recipes():
        return built_in_recipes()[name]
    if name not in PLUGINS.names():
        return None
    loaded = PLUGINS.load(name)
    return loaded if isinstance(loaded, Recipe) else None
