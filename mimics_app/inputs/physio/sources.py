"""Where body signals come from, by an address: sim:PRESET, file:PATH, lsl:NAME, serial:PORT, board:NAME.

An installed package adds a kind by an entry point of the group `mimics_app.signal_sources`: its name before the colon,
its object called with (rest of the address, seed).
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.input_port import SignalSource

__all__ = ["ENTRY_POINT_GROUP", "KINDS", "open_source"]

ENTRY_POINT_GROUP = "mimics_app.signal_sources"

_Opener = Callable[[str, int], SignalSource]


def _simulated(preset: str, seed: int) -> SignalSource:
    from mimics_app.inputs.physio.simulated.source import PRESETS, SimulatedBody

    if preset and preset not in PRESETS:
        raise UsageError(f'there is no simulated person "{preset}"', nearest(preset, PRESETS))
    return SimulatedBody(preset or "moderate", seed)


def _file(path: str, seed: int) -> SignalSource:
    from mimics_app.inputs.physio.recording import FileSource, read_signal_file

    return FileSource(read_signal_file(Path(path)))


def _lsl(name: str, seed: int) -> SignalSource:
    from mimics_app.inputs.physio.lsl import LslSource

    return LslSource(name)


def _serial(address: str, seed: int) -> SignalSource:
    from mimics_app.inputs.physio.serial_amplifier import SerialAmplifier

    return SerialAmplifier(address)


def _board(address: str, seed: int) -> SignalSource:
    from mimics_app.inputs.physio.board import BoardSource

    return BoardSource(address)


KINDS: dict[str, _Opener] = {"sim": _simulated, "file": _file, "lsl": _lsl, "serial": _serial, "board": _board}
"""What comes with the product."""


def open_source(address: str, seed: int) -> SignalSource:
    """Open what an address names.

    Raises:
        UsageError: It names no kind of source, or one that cannot be.
        DeviceError: The source cannot be had.
        SceneError: The file is none, or wrong.
    """
    kind, _, rest = address.partition(":")
    if kind in KINDS and kind != "sim" and not rest:
        raise UsageError(f'"{address}" names no {kind} source', f"write {kind}:NAME")
    if kind in KINDS:
        return KINDS[kind](rest, seed)
    points = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
    if kind in points:
        opener: _Opener = points[kind].load()
        return opener(rest, seed)
    raise UsageError(f'"{address}" is no source of body signals', nearest(kind, [*KINDS, *points]))
