"""A seed for each test of properties: the daily suite draws the same examples every time, whatever ran before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from hypothesis import settings
from hypothesis.internal.reflection import function_digest

DAILY, RANDOM, NIGHTLY = "same", "random", "nightly"
"""The profiles: seeded by the text of each test, seeded by chance, and by chance with many examples."""

_SEED = "_hypothesis_internal_use_seed"
"""What `hypothesis.seed` sets. A test of tests/properties fails if another version of hypothesis names it otherwise."""

Test = TypeVar("Test", bound=Callable[..., Any])


def same_examples(test: Test) -> Test:
    """Seed a test by its own text, unless the profile asks for chance or the test has a seed.

    The collection of the suite does this for every test; a property inside a test function, which no collection sees,
    needs it as its first decorator.
    """
    if settings.get_current_profile_name() == DAILY and getattr(test, _SEED, None) is None:
        inner: Callable[..., Any] = test.hypothesis.inner_test  # type: ignore[attr-defined]
        setattr(getattr(test, "__func__", test), _SEED, int.from_bytes(function_digest(inner), "big"))
    return test
