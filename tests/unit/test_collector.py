"""What exists when a session begins is not looked through again; what it makes and drops is still found."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator

import pytest

from mimics_app.app.play.collector import frozen_objects


@pytest.fixture(autouse=True)
def nothing_frozen_before() -> Iterator[None]:
    """What the suite itself put away comes back for these tests."""
    gc.unfreeze()
    yield
    gc.freeze()


class _Ring:
    def __init__(self) -> None:
        self.itself = self


@pytest.mark.seconds
def test_what_exists_is_left_out_and_what_is_made_is_found():
    gc.collect()
    before = len(gc.get_objects())
    with frozen_objects():
        assert gc.get_freeze_count() > 0.5 * before
        assert len(gc.get_objects()) < 0.1 * before
        dropped = weakref.ref(_Ring())
        gc.collect()
        assert dropped() is None
    assert gc.get_freeze_count() == 0


def test_a_session_that_breaks_off_leaves_the_collector_as_it_was():
    ring = _Ring()
    seen = weakref.ref(ring)
    with pytest.raises(RuntimeError), frozen_objects():
        raise RuntimeError
    assert gc.get_freeze_count() == 0
    del ring
    gc.collect()
    assert seen() is None, "what was frozen is found afterwards"
