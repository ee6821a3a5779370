"""Sources of body signals by their address: sim:PRESET, file:PATH, lsl:NAME, serial:PORT, board:NAME.

An installed package adds a kind by an entry point of the group `mimics_app.signal_sources`: its name before the colon,
its object called with (rest of the address, seed).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, cast

from mimics_app.contracts.errors import DeviceError, Issue, SceneError, UsageError, nearest, short_text
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup, fault_of_builder, made_by
from mimics_app.inputs.physio.guarded_source import CheckRate, GuardedSource, any_rate

if TYPE_CHECKING:
    from mimics_app.inputs.physio.recording import FileSource

__all__ = ["KINDS", "PLUGINS", "find_source", "open_file", "open_source", "source_kinds"]

PLUGINS = PluginGroup("mimics_app.signal_sources", fault_of_builder(SignalSource))

_Opener = Callable[[str, int], SignalSource]


def _simulated(preset: str, seed: int) -> SignalSource:
    from mimics_app.inputs.physio.simulated.source import PRESETS, SimulatedBody

    if preset and preset not in PRESETS:
        raise UsageError(f'unknown simulated person "{preset}"', nearest(preset, PRESETS))
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
    from mimics_app.inputs.physio.brainflow_board import BoardSource

    return BoardSource(address)


KINDS: dict[str, _Opener] = {"sim": _simulated, "file": _file, "lsl": _lsl, "serial": _serial, "board": _board}
"""Built-in kinds of sources."""


def source_kinds() -> set[str]:
    """Return the kinds of sources: the built-in ones, and those of installed packages."""
    return {*KINDS, *PLUGINS.names()}


def open_source(address: str, seed: int, check_rate: CheckRate = any_rate) -> GuardedSource:
    """Open the source of an address; whatever it raises while it is read makes it a lost source.

    Args:
        address: Address of the source.
        seed: Seed of a simulated person.
        check_rate: Checks the rate of each signal.

    Raises:
        UsageError: The address names no kind of source, or an option it does not have.
        DeviceError: The source is not available, its plug-in fails, or a signal has a rate that cannot be processed.
        SceneError: The file is missing, cannot be read, or has a rate that cannot be processed.
    """
    kind, rest = _split(address)
    if kind in KINDS:
        source = KINDS[kind](rest, seed)
        _check_rates(source, address, check_rate)
        return GuardedSource(source, f'the source "{short_text(address)}"', check_rate)
    try:
        made = cast(SignalSource, made_by(_plugin(kind), SignalSource, rest, seed))
    except PluginError as error:
        raise DeviceError(f'the source of body signals "{kind}" cannot be opened: {error}') from error
    return GuardedSource(made, "its plug-in", check_rate)


def open_file(path: Path, check_rate: CheckRate = any_rate) -> FileSource:
    """Open a file of body signals.

    Raises:
        SceneError: It is missing, cannot be read, or has a rate that cannot be processed.
    """
    from mimics_app.inputs.physio.recording import FileSource, read_signal_file

    source = FileSource(read_signal_file(path))
    _check_rates(source, f"file:{path}", check_rate)
    return source


def _check_rates(source: SignalSource, address: str, check_rate: CheckRate) -> None:
    """Check the rates that a source knows before its first sample; close it where one cannot be processed.

    Raises:
        DeviceError, SceneError: See `open_source`.
    """
    from mimics_app.inputs.physio.recording import FileSource

    rates: Mapping[str, float] = getattr(source, "rates", {})
    try:
        for name, rate in rates.items():
            check_rate(name, rate)
    except DeviceError as error:
        source.close()
        if isinstance(source, FileSource):
            fix = f"{error.fix}; where the times are milliseconds, name their column t_ms"
            raise SceneError(Issue(address.partition(":")[2], "", error.what, fix)) from error
        raise DeviceError(f"{short_text(address)}: {error.what}", error.fix) from error


def find_source(address: str, tell: Callable[[str], None]) -> None:
    """Check that the file, port or stream of an address exists; nothing is opened.

    Args:
        address: Address of the source.
        tell: Called with a line of text before a wait.

    Raises:
        UsageError, DeviceError, SceneError: As `open_source`.
    """
    kind, rest = _split(address)
    if kind not in KINDS:
        _plugin(kind)
    elif kind in _LOOKS:
        _LOOKS[kind](rest, tell)


def _find_person(preset: str, tell: Callable[[str], None]) -> None:
    _simulated(preset, 0)


def _find_file(path: str, tell: Callable[[str], None]) -> None:
    from mimics_app.inputs.physio.recording import reader_of

    reader_of(Path(path))


def _find_stream(name: str, tell: Callable[[str], None]) -> None:
    from mimics_app.inputs.physio.lsl import find_stream

    find_stream(name, tell)


def _find_port(address: str, tell: Callable[[str], None]) -> None:
    port = address.partition("@")[0]
    if os.path.isabs(port) and not os.path.exists(port):
        raise DeviceError(f'the serial port "{port}" cannot be opened: nothing is there', "mimics devices lists them")


_LOOKS: dict[str, Callable[[str, Callable[[str], None]], None]] = {
    "sim": _find_person,
    "file": _find_file,
    "lsl": _find_stream,
    "serial": _find_port,
}


def _plugin(kind: str) -> _Opener:
    try:
        return cast(_Opener, PLUGINS.load(kind))
    except PluginError as error:
        raise DeviceError(f'the source of body signals "{kind}" is not available: {error}') from error


def _split(address: str) -> tuple[str, str]:
    """Split an address into kind and rest.

    Raises:
        UsageError: The kind is unknown, or the rest is missing.
    """
    kind, _, rest = address.partition(":")
    if kind in KINDS and kind != "sim" and not rest:
        raise UsageError(f'"{address}" lacks the name of a source', f"write {kind}:NAME")
    if kind not in (known := source_kinds()):
        raise UsageError(f'unknown source of body signals "{address}"', nearest(kind, known))
    return kind, rest
