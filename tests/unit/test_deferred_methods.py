"""Methods of dataclasses that are compiled at their first call behave like those of `dataclasses`."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable
from typing import Any

import pytest

from mimics_app.contracts.deferred_methods import defer_methods

pytestmark = pytest.mark.skipif(not hasattr(dataclasses, "_create_fn"), reason="this Python compiles them at once")


@pytest.fixture
def deferring(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Defer methods for one test; return the names of the methods compiled, in order."""
    create: Callable[..., Any] = vars(dataclasses)["_create_fn"]
    compiled: list[str] = []

    def noted(name: str, *args: Any, **scope: Any) -> Any:
        compiled.append(name)
        return create(name, *args, **scope)

    monkeypatch.setattr(dataclasses, "_create_fn", noted)
    defer_methods()
    return compiled


def _made(**options: bool) -> type:
    @dataclasses.dataclass(**options)
    class Pose:
        x: float
        name: str = "hand"
        near: tuple[int, ...] = dataclasses.field(default=(), compare=False)

    return Pose


FORMS = [
    {},
    {"frozen": True},
    {"frozen": True, "slots": True},
    {"frozen": True, "slots": True, "eq": False},
    {"frozen": True, "order": True},
    {"unsafe_hash": True},
]


def _outcome(call: Callable[[], object]) -> object:
    try:
        return call()
    except (TypeError, AttributeError) as error:  # of which FrozenInstanceError is one
        return type(error), str(error)


def _behaviour(kind: Any) -> list[object]:
    """Return what two equal instances and another one do, twice: the first call compiles."""
    a, b, c = kind(1.0), kind(1.0, near=(2,)), kind(2.0, "foot")
    calls = [
        lambda: repr(c),
        lambda: kind.__eq__(a, other=b),
        lambda: a == b,
        lambda: a == c,
        lambda: a == 1.0,
        lambda: a < c,
        lambda: a >= c,
        lambda: a < 1.0,
        lambda: hash(a) == hash(b),
        lambda: len({a, b, c}),
        lambda: setattr(a, "x", 1.0),
        lambda: setattr(a, "other", 1.0),
        lambda: delattr(c, "name"),
        lambda: dataclasses.asdict(a),
        lambda: dataclasses.replace(a, x=3.0).x,
        lambda: str(inspect.signature(kind)),
        lambda: (kind.__repr__.__qualname__, kind.__eq__.__qualname__, kind.__hash__ is None),
    ]
    return [_outcome(call) for _ in range(2) for call in calls]


@pytest.mark.parametrize("form", FORMS, ids=str)
def test_deferred_methods_do_the_same(form: dict[str, bool], request: pytest.FixtureRequest) -> None:
    usual = _behaviour(_made(**form))
    request.getfixturevalue("deferring")
    assert _behaviour(_made(**form)) == usual


def test_a_method_is_compiled_at_its_first_call(deferring: list[str]) -> None:
    made = _made(frozen=True, slots=True)
    assert deferring == ["__init__"]
    first = made.__eq__
    assert made(1.0) == made(1.0)
    assert made(1.0) != made(2.0)
    assert deferring == ["__init__", "__eq__"]
    assert made.__eq__ is not first, "the compiled method takes the place of the other"


def test_a_subclass_calls_the_method_of_its_base(deferring: list[str]) -> None:
    derived = type("Derived", (_made(frozen=True),), {})
    assert repr(derived(1.0)).endswith("Derived(x=1.0, name='hand', near=())")
    assert hash(derived(1.0)) == hash(derived(1.0))
    assert "__hash__" not in vars(derived)
    assert deferring.count("__hash__") == 1
