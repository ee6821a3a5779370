"""Files spoiled at random: bytes, structure of JSON, numbers at their edges, types exchanged, halves of characters.

A reader may take a spoiled file or refuse it by an error of `contracts.errors` that names the file. Anything else is a
finding, kept with the seed that makes the same file again: `spoil(original, seed)`. So are 2 s and 512 MB.
"""

from __future__ import annotations

import copy
import json
import random
import re
import signal
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from numba.core.errors import NumbaExperimentalFeatureWarning

from mimics_app.contracts.errors import MimicsError
from tests.support.resident import resident_mb

__all__ = ["EDGES", "Survey", "as_text", "spoil_bytes", "spoil_json", "survey"]

EDGES: tuple[Any, ...] = (
    *(0, 1, -1, 2, 3, 255, 256, 65535, 65536, 100_001, 50_000_001, 2**31 - 1, 2**31, 2**32 - 1, 2**53 + 1),
    *(2**63 - 1, 2**63, 2**64, -(2**63), 10**15, 10**30, 10**308, 10**309, 10**400, -(10**400)),
    *(0.0, -0.0, 5e-324, 1e-300, 1e-30, 1e-12, 0.5, 1.0 + 1e-9, 1e15, 1e30, 3e38, -3e38, 1e300, 1.797e308, -1.797e308),
    *(float("nan"), float("inf"), float("-inf")),
)
"""Numbers at which a reader changes its mind, or a type ends."""

TEXTS: tuple[str, ...] = (
    *("", " ", ".", "..", "/", "a.b", "#", "a#/nodes/", "x-", "0", "-1", "NaN", "null", "é", "\U0001f600", "\0", "\n"),
    *("~", "\ud800", "a\udfffb", "\udc80.bin", "%00", "%2e%2e/x", "C:\\x", "http://x/y", "mimics:", "file:///etc"),
    *("data:", "data:,", "data:;base64,====", "data:;base64,AAAA", "<script>", "x" * 5000, "é" * 300),
)
"""Texts that are no names, no files, or no characters at all."""

OTHERS: tuple[Any, ...] = (None, True, False, [], {}, [[]], [{}], {"": {}}, [None], {"a": []}, {"\ud800": 1}, [0] * 300)
"""What is neither a number nor a text."""


def spoil_bytes(data: bytes, seed: int) -> bytes:
    """The bytes with one to four faults: bits flipped, pieces cut out, doubled, moved or overwritten, the end lost."""
    rng = random.Random(seed)
    spoiled = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        rng.choice(_BYTE_FAULTS)(rng, spoiled)
    return bytes(spoiled)


def spoil_json(document: Any, seed: int) -> Any:
    """A copy of a JSON document with one to three faults of structure or value."""
    rng = random.Random(seed)
    spoiled = [copy.deepcopy(document)]
    for _ in range(rng.randint(1, 3)):
        places = list(_places(spoiled))
        if not places:
            break
        holder, key = rng.choice(places)
        rng.choice(_JSON_FAULTS)(rng, holder, key)
    return spoiled[0] if spoiled else None


def as_text(document: Any) -> bytes:
    """The document as JSON; NaN as the token it is not allowed to be, halves of characters as escapes."""
    return json.dumps(document).encode()


MOST_S, MOST_MB = 2.0, 512.0
"""Time on the processor for one file [s]; memory that all of them may need beside what was held before [MB]."""
PATIENCE_S = 60.0
"""Time on the processor after which a reader hangs [s]: a kernel that it needs may be compiled meanwhile."""


class Hangs(BaseException):
    """A reader takes no end; no reader may take this for an error of its file."""


@dataclass
class Survey:
    """What a reader made of many spoiled files.

    Attributes:
        read: How many it took.
        refused: How many it refused by an error of its own that names a file.
        findings: For each other one its seed and what went wrong, with the last lines of the traceback.
    """

    read: int = 0
    refused: int = 0
    findings: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return f"{self.read} read, {self.refused} refused, {len(self.findings)} findings\n" + "\n".join(
            self.findings[:10]
        )


def survey(read: Callable[[int], object], seeds: range) -> Survey:
    """Call a reader once for each seed; a warning of a library on the terminal is a finding too."""
    found = Survey()
    held = _begin_peak()
    with warnings.catch_warnings(), _patience():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", NumbaExperimentalFeatureWarning)  # it is about a kernel compiled meanwhile
        for seed in seeds:
            if _timed(read, seed, found) > MOST_S and (seconds := _timed(read, seed, Survey())) > MOST_S:
                found.findings.append(f"seed {seed}: took {seconds:.1f} s")
    if (needed := _peak_mb() - held) > MOST_MB:
        found.findings.append(f"needed {needed:.0f} MB")
    return found


def _timed(read: Callable[[int], object], seed: int, found: Survey) -> float:
    """Let the reader read once; return its time on the processor [s]."""
    begun = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, PATIENCE_S)
    try:
        read(seed)
        found.read += 1
    except MimicsError as error:
        found.refused += 1
        found.findings += [f"seed {seed}: {fault}" for fault in _faults_of_refusal(error)]
    except (Exception, Hangs):  # noqa: BLE001  any other one is what is looked for
        last = "".join(traceback.format_exc().splitlines(keepends=True)[-7:])
        found.findings.append(f"seed {seed}: {last}")
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return time.process_time() - begun


@contextmanager
def _patience() -> Iterator[None]:
    """A reader that hangs is interrupted."""

    def give_up(*_: object) -> None:
        raise Hangs(f"no end after {PATIENCE_S:.0f} s")

    before = signal.signal(signal.SIGPROF, give_up)
    try:
        yield
    finally:
        signal.signal(signal.SIGPROF, before)


def _begin_peak() -> float:
    """Forget the most memory held so far; return what is held now [MB]."""
    Path("/proc/self/clear_refs").write_text("5")
    return resident_mb()


def _peak_mb() -> float:
    peak = re.search(r"VmHWM:\s*(\d+)", Path("/proc/self/status").read_text())
    return int(peak[1]) / 1024 if peak else 0.0


def _faults_of_refusal(error: MimicsError) -> Iterator[str]:
    """What is wrong with a refusal: it names no file, cannot be printed, or is a page long."""
    for issue in error.issues:
        line = str(issue)
        if not issue.file:
            yield f"no file in {line!r:.200}"
        elif line.encode("utf-8", "replace").decode() != line:
            yield f"cannot be printed: {line!r:.200}"
        elif len(line) > 2000:
            yield f"a line of {len(line)} characters: {line[:100]}"


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """(holder, key) of every value in lists and objects below, the value itself left out."""
    waiting = [value]
    while waiting:
        holder = waiting.pop()
        items = holder.items() if isinstance(holder, dict) else enumerate(holder)
        for key, item in items:
            yield holder, key
            if isinstance(item, dict | list):
                waiting.append(item)


def _flip(rng: random.Random, data: bytearray) -> None:
    if data:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def _overwrite(rng: random.Random, data: bytearray) -> None:
    at = rng.randrange(len(data) + 1)
    data[at : at + 4] = rng.choice((b"\xff\xff\xff\xff", b"\0\0\0\0", b"\0\0\0\x80", rng.randbytes(4)))


def _cut(rng: random.Random, data: bytearray) -> None:
    at = rng.randrange(len(data) + 1)
    del data[at : at + rng.choice((1, 2, 4, 50, len(data)))]


def _double(rng: random.Random, data: bytearray) -> None:
    at = rng.randrange(len(data) + 1)
    data[at:at] = data[at : at + rng.choice((1, 4, 30))]


def _insert(rng: random.Random, data: bytearray) -> None:
    at = rng.randrange(len(data) + 1)
    data[at:at] = rng.choice((b"\xff", b"\0", b'"', b"{", b"]", b"[" * 300, b"1" * 400, b"\\ud800", b",", b"e999"))


def _put_edge(rng: random.Random, holder: Any, key: Any) -> None:
    holder[key] = rng.choice(EDGES)


def _put_text(rng: random.Random, holder: Any, key: Any) -> None:
    holder[key] = rng.choice(TEXTS)


def _put_other(rng: random.Random, holder: Any, key: Any) -> None:
    holder[key] = copy.deepcopy(rng.choice(OTHERS))


def _exchange_type(rng: random.Random, holder: Any, key: Any) -> None:
    value = holder[key]
    holder[key] = rng.choice(([value], {"a": value}, json.dumps(value), None, not value))


def _scale(rng: random.Random, holder: Any, key: Any) -> None:
    value = holder[key]
    if isinstance(value, int | float) and not isinstance(value, bool):
        holder[key] = value * rng.choice((-1, 0, 2, 1000, 10**12, 1e-9)) if abs(value) < 1e200 else -value
    else:
        _put_edge(rng, holder, key)


def _remove(rng: random.Random, holder: Any, key: Any) -> None:
    del holder[key]


def _repeat(rng: random.Random, holder: Any, key: Any) -> None:
    if isinstance(holder, list):
        holder[key:key] = [copy.deepcopy(holder[key])] * rng.choice((1, 2, 200))
    else:
        holder[f"{key}{rng.choice(('', '2', ' '))}x"] = copy.deepcopy(holder[key])


def _rename(rng: random.Random, holder: Any, key: Any) -> None:
    if isinstance(holder, dict):
        holder[rng.choice(TEXTS)] = holder.pop(key)
    else:
        rng.shuffle(holder)


_BYTE_FAULTS = (_flip, _flip, _overwrite, _cut, _double, _insert)
_JSON_FAULTS = (_put_edge, _put_edge, _put_text, _put_other, _exchange_type, _scale, _remove, _repeat, _rename)
