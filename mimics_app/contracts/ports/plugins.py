"""Plug-ins of installed packages: the groups of entry points, and what an object in each has to be."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import MimicsError, short_text

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["PluginError", "PluginGroup", "fault_of_builder", "made_by", "raised"]


class PluginError(ValueError):
    """A plug-in cannot be imported, or is not what its group needs.

    Attributes:
        fault: What is wrong, in a sentence without a subject.
    """

    def __init__(self, target: str, fault: str) -> None:
        super().__init__(f"its plug-in {target} {fault}")
        self.fault = fault


@dataclass(frozen=True, slots=True)
class PluginGroup:
    """A group of entry points, loaded by the stage that declares it.

    Attributes:
        name: Name of the group, "mimics_app.KIND".
        fault_of: Why an object cannot be the plug-in of a name, in a sentence without a subject; "" where it can.
    """

    name: str
    fault_of: Callable[[str, object], str]

    def points(self) -> list[EntryPoint]:
        """Return the installed entry points, by name."""
        from importlib.metadata import entry_points

        return sorted(entry_points(group=self.name), key=lambda point: (point.name, point.value))

    def names(self) -> list[str]:
        """Return the names of the installed plug-ins, whether they can be loaded or not."""
        return [point.name for point in self.points()]

    def load(self, name: str) -> object:
        """Return the plug-in of an installed name.

        Raises:
            PluginError: It cannot be imported, or is not what the group needs.
        """
        return self.load_point(next(point for point in self.points() if point.name == name))

    def load_point(self, point: EntryPoint) -> object:
        """Return the plug-in of an entry point.

        Raises:
            PluginError: It cannot be imported, or is not what the group needs.
        """
        try:
            loaded: object = point.load()
        except BaseException as error:  # a third-party module may raise anything on import, or call sys.exit()
            if isinstance(error, KeyboardInterrupt):
                raise
            why = short_text(" ".join(f"{type(error).__name__}: {error}".split()))  # a compiler says it in twenty lines
            raise PluginError(point.value, f"cannot be imported: {why}") from error
        if fault := self.fault_of(point.name, loaded):
            raise PluginError(point.value, fault)
        return loaded

    def load_sound(self, what: str) -> Iterator[tuple[str, object]]:
        """Yield (name, plug-in) of those that can be loaded; report the others on stderr as `what`."""
        for point in self.points():
            try:
                yield point.name, self.load_point(point)
            except PluginError as error:
                sys.stderr.write(f'mimics: the {what} "{point.name}" is left out: {error}\n')


def made_by(builder: Callable[..., object], port: type, *arguments: object) -> object:
    """Return what the builder of a plug-in makes: an object of a class or of a protocol that can be checked.

    Raises:
        PluginError: It raises an error other than a MimicsError, which passes, or makes something else.
    """
    target = f"{builder.__module__}:{getattr(builder, '__qualname__', type(builder).__name__)}"
    try:
        made = builder(*arguments)
    except MimicsError:
        raise
    except Exception as error:  # of a third party
        raise PluginError(target, raised(error)) from error
    if isinstance(made, port):
        return made
    members = [name for name in vars(port) if not name.startswith("_")] if getattr(port, "_is_protocol", False) else []
    lacking = [name for name in members if not hasattr(made, name)]
    what = f"of the type {type(made).__name__}" + (f", which lacks {', '.join(lacking)}" if lacking else "")
    raise PluginError(target, f"made an object {what}; see {port.__module__}.{port.__name__}")


def raised(error: Exception) -> str:
    """Return "raised ValueError: no port (amplifier.py, line 21)" for an error that a plug-in raised."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    why = short_text(" ".join(f"{type(error).__name__}: {error}".split()))
    return f"raised {why} ({Path(place.filename).name}, line {place.lineno})"


def fault_of_builder(port: type) -> Callable[[str, object], str]:
    """Return the check of a group whose plug-ins make objects of a protocol: functions, or classes with its methods.

    Attributes are not looked for: a class may set them when it makes an object.
    """

    def fault_of(_: str, loaded: object) -> str:
        if not callable(loaded):
            return f"cannot be called to make a {port.__module__}.{port.__name__}"
        methods = [name for name, member in vars(port).items() if callable(member) and not name.startswith("_")]
        lacking = [name for name in methods if isinstance(loaded, type) and not hasattr(loaded, name)]
        return f"lacks {', '.join(lacking)}, see {port.__module__}.{port.__name__}" if lacking else ""

    return fault_of
