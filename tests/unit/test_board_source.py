"""BrainFlow's synthetic board as a source, where the library is installed."""

from __future__ import annotations

import time

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.inputs.physio.sources import open_source
from tests.support.signal_source_kit import FRAME_NS, check_signal_source

pytest.importorskip("brainflow")
pytest.importorskip("pkg_resources", reason="brainflow finds its library by pkg_resources, which is not here")


def test_the_synthetic_board_sends_body_signals() -> None:
    source = open_source("board:SYNTHETIC_BOARD", 1)
    try:
        names: set[str] = set()
        count = 0
        end = time.monotonic() + 20.0
        while count < 100 and time.monotonic() < end:
            for block in source.read(time.monotonic_ns()):
                names.add(block.name)
                count += len(block.values)
                assert np.isfinite(block.values).all()
            time.sleep(0.05)
        assert count >= 100
        assert names & {"ecg", "gsr", "emg", "resp"}
    finally:
        source.close()


def test_a_board_that_is_not_known_is_reported() -> None:
    with pytest.raises(UsageError, match="has no board"):
        open_source("board:NO_SUCH_BOARD", 1)


def test_the_synthetic_board_keeps_the_contract() -> None:
    def wait(frame: int) -> int:
        time.sleep(FRAME_NS * 1e-9)
        return time.monotonic_ns()

    check_signal_source(open_source("board:SYNTHETIC_BOARD", 1), wait)
