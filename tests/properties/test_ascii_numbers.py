"""Numbers as ASCII in compiled code against Python's own float() and formatting."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from mimics_app.rendering.haptic.devices.ascii_numbers import read_number, write_fixed, write_whole
from tests.support.examples import same_examples

CASES = settings(max_examples=500)


def _read(text: str) -> tuple[float, int]:
    data = np.frombuffer(text.encode(), np.uint8).copy()
    return read_number(data, 0, len(data))


@CASES
@given(st.integers(-(10**15) + 1, 10**15 - 1), st.integers(0, 15), st.sampled_from(["", "e0", "e+5", "E-7", "e12"]))
@example(0, 0, "")
@example(-5, 3, "e-7")
def test_up_to_15_digits_are_read_exactly_as_float_does(digits: int, decimals: int, exponent: str):
    """Powers from -22 to 12: within the exact ones."""
    sign, whole = ("-" if digits < 0 else ""), str(abs(digits)).rjust(decimals + 1, "0")
    text = f"{sign}{whole[: len(whole) - decimals]}.{whole[len(whole) - decimals :]}" if decimals else f"{sign}{whole}"
    value, end = _read(text + exponent)
    assert end == len(text + exponent)
    assert value == float(text + exponent)


@CASES
@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e200, max_value=1e200))
def test_any_number_python_writes_is_read_to_the_last_places(value: float):
    """17 digits round once; steps of 10^22 add 2^-53 each, at most 15 of them for 1e-324 to 1e200."""
    read, end = _read(repr(value))
    assert end == len(repr(value))
    assert abs(read - value) <= 4e-15 * abs(value) + 1e-320


@CASES
@given(st.floats(-1e6, 1e6), st.integers(0, 9))
def test_written_numbers_are_the_nearest_decimal(value: float, decimals: int):
    text = np.zeros(40, np.uint8)
    end = write_fixed(value, decimals, text, 0)
    written = text[:end].tobytes().decode()
    unit = 10.0**-decimals
    assert abs(float(written) - value) <= 0.5 * unit * (1 + 1e-9) + 1e-9 * unit + 2e-16 * abs(value)
    assert len(written.partition(".")[2]) == decimals
    assert _read(written) == (float(written), end)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf"), 1e300])
def test_what_cannot_be_written_is_zero(value: float):
    text = np.zeros(40, np.uint8)
    assert text[: write_fixed(value, 2, text, 0)].tobytes() == b"0.00"


@pytest.mark.parametrize("text", ["", "-", "+", ".", "[1", "e5", "--3", "abc"])
def test_no_number_is_reported_as_none(text: str):
    assert _read(text) == (0.0, 0)


_LIKE_A_NUMBER = st.from_regex(r"[+-]?[0-9]{0,17}\.?[0-9]{0,6}([eE][+-]?[0-9]{0,2})?[;,\] ]?", fullmatch=True)


@pytest.mark.seconds
def test_any_text_ends_and_what_is_read_is_what_float_reads():
    seen = []

    @same_examples
    @CASES
    @given(st.one_of(_LIKE_A_NUMBER, st.text("0123456789+-.eE;,[] ", max_size=30)))
    def check(text: str):
        value, end = _read(text)
        assert 0 <= end <= len(text) and not np.isnan(value)
        if end:
            assert value == pytest.approx(float(text[:end]), rel=4e-15, abs=1e-320)
        seen.append(text[:end].lower())

    check()
    fractions, powers = sum("." in read for read in seen), sum("e" in read for read in seen)
    assert min(fractions, powers, seen.count("")) >= 20, (fractions, powers, seen.count(""))


def test_whole_numbers():
    text = np.zeros(20, np.uint8)
    for value in (0, 7, 10, 65535, 10**15):
        assert text[: write_whole(value, text, 0)].tobytes() == str(value).encode()
