"""Dataclasses that compile a method at its first call."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

__all__ = ["defer_methods"]

_Method = Callable[..., object]


def defer_methods() -> None:
    """Let classes that `dataclasses` makes from now on compile all methods but `__init__` at their first call.

    Python up to 3.12 compiles six methods of a frozen dataclass one by one from text while the class is made: of the
    280 classes of a start, nobody compares, hashes or prints most. From its first call on a method is the same as
    without this. A later Python compiles the methods of a class at once, in half of the time, and is left as it is.
    """
    create: Callable[..., _Method] | None = getattr(dataclasses, "_create_fn", None)
    if create is not None:
        vars(dataclasses)["_create_fn"] = _deferring(create)


def _deferring(create: Callable[..., _Method]) -> Callable[..., _Method]:
    def create_deferred(name: str, *source: object, **scope: object) -> _Method:
        if name == "__init__":
            return create(name, *source, **scope)
        compiled: list[_Method] = []

        def method(self: object, *given: object, **named: object) -> object:
            if not compiled:
                compiled.append(create(name, *source, **scope))
                compiled[0].__qualname__ = method.__qualname__
                for owner in type(self).__mro__:
                    if vars(owner).get(name) is method:
                        setattr(owner, name, compiled[0])
            return compiled[0](self, *given, **named)

        method.__name__ = name
        return method

    return create_deferred
