"""Ctrl-C and SIGTERM are not lost in PyOpenAL, whose bare `except:` clauses swallow what is raised while it loads."""

from __future__ import annotations

import signal

import pytest

from mimics_app.rendering.audio.openal_library import _signals_held


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_in_a_bare_except_is_raised_afterwards(number: signal.Signals) -> None:
    def leave(number: int, _frame: object) -> None:
        raise SystemExit(128 + number)

    before = signal.signal(number, leave)
    try:
        swallowed = False
        with pytest.raises(SystemExit), _signals_held():
            try:
                signal.raise_signal(number)
            except BaseException:  # noqa: BLE001  what PyOpenAL does
                swallowed = True
        assert not swallowed
        assert signal.getsignal(number) is leave
    finally:
        signal.signal(number, before)


def test_ignored_signals_stay_ignored() -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with _signals_held():
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
            signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGTERM, before)
