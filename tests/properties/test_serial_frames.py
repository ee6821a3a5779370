"""Frames of the serial robot: checksum, resynchronisation, sequence, for any bytes."""

from __future__ import annotations

import binascii

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_LENGTH,
    COMMAND_STATE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_LENGTH,
    DATA_Q,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_LENGTH,
    INBOX_TARGET,
    INBOX_TRIAL,
)
from mimics_app.rendering.haptic.devices import serial_frames as frames
from mimics_app.rendering.haptic.devices import serial_payloads as payloads
from tests.support.examples import same_examples

CASES = settings(max_examples=200)


def _frame(kind: int, sequence: int, payload: bytes, echo: int = 0) -> bytes:
    room = np.zeros(frames.OVERHEAD + frames.MAX_PAYLOAD, np.uint8)
    room[frames.HEADER : frames.HEADER + len(payload)] = np.frombuffer(payload, np.uint8)
    return room[: frames.seal_frame(room, kind, sequence, echo, len(payload))].tobytes()


def _read(stream: bytes, pieces: list[int]) -> tuple[list[bytes], np.ndarray]:
    """Whole frames found in a stream that comes in pieces, and what the reader counted."""
    line, buffer = np.zeros(frames.LINE_LENGTH), np.zeros(1024, np.uint8)
    found: list[bytes] = []
    for piece in [*pieces, 1 << 20]:
        while stream:
            start = frames.make_room(line, buffer)
            now, stream = stream[: min(piece, 1024 - start)], stream[min(piece, 1024 - start) :]
            buffer[start : start + len(now)] = np.frombuffer(now, np.uint8)
            line[frames.END] = start + len(now)
            while (at := frames.next_frame(line, buffer)) >= 0:
                found.append(buffer[at : at + frames.OVERHEAD + int(buffer[at + 2])].tobytes())
            if piece != 1 << 20:
                break
    return found, line


@CASES
@given(st.binary(max_size=80))
def test_checksum_is_the_crc_16_of_the_books(data: bytes):
    """CRC-16/CCITT-FALSE; the standard library has the same polynomial, started from a value of one's choice."""
    assert frames.crc16(np.frombuffer(data, np.uint8).copy(), 0, len(data)) == binascii.crc_hqx(data, 0xFFFF)


@CASES
@given(st.binary(min_size=1, max_size=64), st.integers(0, 65535), st.data())
def test_no_changed_byte_passes(payload: bytes, sequence: int, data: st.DataObject):
    """A CRC of 16 bits finds every error burst of up to 16 bits; a changed byte is one of 8."""
    frame = bytearray(_frame(frames.STATE, sequence, payload))
    place = data.draw(st.integers(0, len(frame) - 1))
    frame[place] ^= data.draw(st.integers(1, 255))
    found, _ = _read(bytes(frame), [])
    assert bytes(frame) not in found


_FALSE_BEGINNING = st.builds(lambda length, rest: bytes([0xA5, 0x5A, length]) + rest, st.integers(0, 255), st.binary())
_GARBAGE = st.lists(st.one_of(st.binary(max_size=60), _FALSE_BEGINNING), max_size=12).map(
    lambda parts: b"".join(parts)[:300]
)
"""Bytes that among other things look like the beginning of a frame, which random ones do once in 65,536 times."""


def test_every_whole_frame_behind_garbage_is_found():
    """At most what a false beginning may swallow is lost: one frame of the largest size, here the first two."""
    lines = []

    @same_examples
    @CASES
    @given(_GARBAGE, st.lists(st.binary(max_size=64), min_size=3, max_size=8), st.lists(st.integers(1, 99)))
    def check(garbage: bytes, bodies: list[bytes], pieces: list[int]):
        sent = [_frame(frames.COMMAND, n, body) for n, body in enumerate(bodies)]
        padding = [_frame(frames.COMMAND, 99, bytes(64))] * 2
        found, line = _read(garbage + b"".join(padding + sent), pieces)
        assert found[-len(sent) :] == sent
        lines.append(line)

    check()
    reached = np.array(lines)[:, [frames.GARBAGE, frames.BAD_CHECKSUMS]]
    assert (np.count_nonzero(reached, axis=0) >= 0.2 * len(lines)).all(), "no frame was begun that was none"


@CASES
@given(st.lists(st.binary(max_size=64), min_size=1, max_size=8), st.lists(st.integers(1, 40)))
def test_frames_in_any_pieces_come_out_whole_and_nothing_is_garbage(bodies: list[bytes], pieces: list[int]):
    sent = [_frame(frames.STATE, n, body) for n, body in enumerate(bodies)]
    found, line = _read(b"".join(sent), pieces)
    assert found == sent
    assert line[frames.GARBAGE] == line[frames.BAD_CHECKSUMS] == 0.0


@CASES
@given(st.integers(0, 65535), st.lists(st.integers(0, 40), min_size=1, max_size=40))
def test_sequence_counts_what_is_lost_double_or_late(first: int, steps: list[int]):
    """Against a model with numbers that do not wrap."""
    line = np.zeros(frames.LINE_LENGTH)
    newest, lost, double, late = first, 0, 0, 0
    assert frames.accept_sequence(line, first, 0)
    for tick, step in enumerate(steps):
        number = newest + step - 10
        fresh = frames.accept_sequence(line, number & 0xFFFF, min(tick, 15))
        assert fresh == (number > newest)
        lost += max(0, number - newest - 1)
        double += number == newest
        late += number < newest
        newest = max(newest, number)
    assert [line[frames.LOST], line[frames.DUPLICATES], line[frames.REORDERED]] == [lost, double, late]


def test_a_robot_that_starts_again_is_heard_after_20_ticks():
    line = np.zeros(frames.LINE_LENGTH)
    assert frames.accept_sequence(line, 5000, 100)
    assert not frames.accept_sequence(line, 1, 110)
    assert frames.accept_sequence(line, 2, 121)


_NUMBER = st.floats(-1e3, 1e3, width=32)


@CASES
@given(st.lists(_NUMBER, min_size=10, max_size=10), st.integers(0, 255), st.integers(0, 2), st.integers(0, 65535))
def test_state_comes_out_as_it_went_in(numbers: list[float], buttons: int, status: int, age_us: int):
    data, out, payload = np.zeros(DATA_LENGTH), np.zeros(DATA_LENGTH), np.zeros(payloads.PAYLOAD_PLACES)
    for i, place in enumerate((DATA_Q, DATA_DQ, DATA_FORCE)):
        data[place : place + 3] = numbers[3 * i : 3 * i + 3]
    data[DATA_GRASP], data[DATA_BUTTONS], age = numbers[9], buttons, age_us * 1e-6
    data[DATA_AGE] = age
    payloads.pack_state(data, status, payload)
    data[DATA_AGE] = 0.0
    assert payloads.unpack_state(payload, out) == status
    assert abs(out[DATA_AGE] - age) < 1.01e-6
    out[DATA_AGE] = 0.0
    assert np.array_equal(out, data)


@CASES
@given(st.lists(_NUMBER, min_size=6, max_size=6), st.booleans(), st.booleans())
def test_command_and_screen_come_out_as_they_went_in(numbers: list[float], enabled: bool, usable: bool):
    command, out, payload = np.zeros(COMMAND_LENGTH), np.ones(COMMAND_LENGTH), np.zeros(payloads.PAYLOAD_PLACES)
    command[COMMAND_DQ : COMMAND_DQ + 3], command[COMMAND_FORCE : COMMAND_FORCE + 3] = numbers[:3], numbers[3:]
    command[COMMAND_ENABLED], command[COMMAND_STATE] = enabled, 4
    out[COMMAND_FORCE + 3 : COMMAND_ENABLED] = out[COMMAND_DQ + 3 : COMMAND_FORCE] = 0.0  # it has no such joints
    out[COMMAND_STATE + 1 :] = 0.0  # and no belt
    payloads.pack_command(command, usable, payload)
    payloads.unpack_command(payload, out)
    assert np.array_equal(out, command if usable else np.zeros(COMMAND_LENGTH))
    inbox, seen = np.zeros(INBOX_LENGTH), np.ones(INBOX_LENGTH)
    inbox[INBOX_TARGET : INBOX_TARGET + 3], inbox[INBOX_GRASP] = numbers[:3], numbers[3]
    inbox[INBOX_BUTTONS], inbox[INBOX_ACTIVE], inbox[INBOX_TRIAL] = 3.0, float(enabled), 70000.0
    payloads.pack_screen(inbox, payload)
    payloads.unpack_screen(payload, seen)
    shown = [INBOX_TARGET, INBOX_TARGET + 1, INBOX_TARGET + 2, INBOX_GRASP, INBOX_BUTTONS, INBOX_ACTIVE]
    assert np.array_equal(seen[shown], inbox[shown]) and seen[INBOX_TRIAL] == 70000 % 65536
