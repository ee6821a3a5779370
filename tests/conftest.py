"""The same examples every time, and those that were found: a chance find belongs to `make test-long`, not to the day.

What `make test-long` and `make nightly` find is kept in `tests/properties/found`, and tried first from then on: by both
of them, and by `make test` too, by everybody once it is committed. Its line `@reproduce_failure` says how to see it.
The fault corrected, it becomes an `@example` of the test, which stays when the test's text changes.
"""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import is_hypothesis_test, settings
from hypothesis.database import DirectoryBasedExampleDatabase, ReadOnlyDatabase

from tests.support.examples import DAILY, NIGHTLY, RANDOM, same_examples

FOUND = Path(__file__).parent / "properties" / "found"
COLLECTOR = (50_000, 20, 20)
"""Thresholds of the garbage collector: syntax trees and compilers make millions of objects that are no rubbish."""

_FOUND = DirectoryBasedExampleDatabase(FOUND)

# No deadlines: an example may meet a compilation, or a machine at work.
# `derandomize`, `@seed` and a global seed all switch the kept examples off: a seed of each test does not, see below.
settings.register_profile(DAILY, derandomize=False, deadline=None, database=ReadOnlyDatabase(_FOUND))
settings.register_profile(RANDOM, derandomize=False, deadline=None, print_blob=True, database=_FOUND)
settings.register_profile(NIGHTLY, parent=settings.get_profile(RANDOM), max_examples=2000)
settings.load_profile(DAILY)

# Texts are compared in English, whatever the language of who tests.
os.environ["LANGUAGE"] = "en"

# Threads of a BLAS wait for each other by spinning, and three processes of tests have two processors between them. With
# one thread its sums are in one order, too, on every machine. Nothing has imported NumPy yet.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# A job in the background of a shell ignores Ctrl-C, and so would every program that a test starts and interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config: pytest.Config) -> None:
    """Before workers for whole folders of tests start, compile what they would compile beside each other."""
    folders = [Path(argument).resolve() for argument in config.args]
    if all(folder.is_dir() for folder in folders):
        from tests.support.compile_first import compile_first

        compile_first(folders)


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Generator[None, object, object]:
    """Nothing that is imported and collected is rubbish: the collector looks through none of it, now or later."""
    gc.disable()
    if hasattr(session.config, "workerinput") or not session.config.getoption("numprocesses", default=None):
        keep_models()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()
        gc.set_threshold(*COLLECTOR)


def keep_models() -> None:
    """Hundreds of tests load one of some dozen scenes, whose models are decoded once for all of them."""
    from mimics_app.world.files.scene.model_shelf import MODELS

    MODELS.keep()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Beside each other the longest files begin first; every test draws from a seed of its own."""
    if hasattr(config, "workerinput"):
        from tests.support.order import longest_first

        longest_first(items)
    for item in items:
        if is_hypothesis_test(test := getattr(item, "obj", None)):
            same_examples(test)
