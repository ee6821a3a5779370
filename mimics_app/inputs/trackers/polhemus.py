"""Polhemus Fastrak in ASCII, which InterSense devices speak too: records of 47 bytes, inches or centimetres.

A record is station "01", a space or an error letter, six numbers of seven characters (x y z, azimuth, elevation, roll
in degrees), and CR LF. It has no check sum: only its form can be checked, and the next record.
"""

from __future__ import annotations

import math
import re

from mimics_app.contracts.tracker_port import TrackerSample

__all__ = ["RECORD_BYTES", "FastrakParser", "euler_quaternion", "fastrak_record"]

RECORD_BYTES = 47
_FORM = re.compile(rb"0([1-4]) ((?: *-?\d{1,3}\.\d\d){6})\r\n")
_MOST_WAITING = 4096
"""Bytes kept without a whole record among them; then they are no Fastrak's."""


class FastrakParser:
    """Finds whole records in what arrives, however it is cut; of a broken one nothing is used.

    Args:
        metres: Per unit of the device.

    Attributes:
        rejected: Lines that were no record.
    """

    def __init__(self, metres: float) -> None:
        self._metres = metres
        self._waiting = bytearray()
        self.rejected = 0

    def feed(self, data: bytes, t_ns: int) -> list[TrackerSample]:
        """Take bytes that arrived at a time [ns]; returns what is whole now."""
        self._waiting += data
        found = []
        while (end := self._waiting.find(b"\n")) >= 0:
            line = bytes(self._waiting[: end + 1])
            del self._waiting[: end + 1]
            sample = self._read(line, t_ns)
            if sample is None:
                self.rejected += 1
            else:
                found.append(sample)
        if len(self._waiting) > _MOST_WAITING:
            self.rejected += 1
            self._waiting.clear()
        return found

    def _read(self, line: bytes, t_ns: int) -> TrackerSample | None:
        match = _FORM.fullmatch(line)
        if match is None or len(line) != RECORD_BYTES:
            return None
        # Numbers stand in columns: a byte lost in one of them and gained in another shows in the points.
        columns = [line[3 + 7 * i : 10 + 7 * i] for i in range(6)]
        if any(column[4:5] != b"." for column in columns):
            return None
        x, y, z, azimuth, elevation, roll = (float(column) for column in columns)
        if max(abs(azimuth), abs(roll)) > 180.0 or abs(elevation) > 90.0:
            return None
        place = (x * self._metres, y * self._metres, z * self._metres)
        return TrackerSample(match[1].decode(), t_ns, place, euler_quaternion(azimuth, elevation, roll))


def fastrak_record(
    station: int, position: tuple[float, float, float], angles: tuple[float, float, float], metres: float
) -> bytes:
    """The record of a station, for emulators.

    Args:
        station: 1 to 4.
        position: [m].
        angles: Azimuth, elevation, roll [deg].
        metres: Per unit of the device.
    """
    numbers = (*(value / metres for value in position), *angles)
    return b"0%d " % station + b"".join(b"%7.2f" % value for value in numbers) + b"\r\n"


def euler_quaternion(azimuth: float, elevation: float, roll: float) -> tuple[float, float, float, float]:
    """Quaternion x y z w of turns about z, then the new y, then the new x [deg]: both makers' convention."""
    a, e, r = (math.radians(angle) / 2.0 for angle in (azimuth, elevation, roll))
    ca, sa, ce, se, cr, sr = math.cos(a), math.sin(a), math.cos(e), math.sin(e), math.cos(r), math.sin(r)
    return (
        ca * ce * sr - sa * se * cr,
        ca * se * cr + sa * ce * sr,
        sa * ce * cr - ca * se * sr,
        ca * ce * cr + sa * se * sr,
    )
