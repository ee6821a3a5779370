"""Damages a run folder in one of the ways disks, crashes and strangers do; the seed says which."""

from __future__ import annotations

import json
import os
import random
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.recording.arrow_format import encode_parameters, encode_samples
from mimics_app.recording.run import Run
from tests.support.synthetic_run import packed, scene_block

SEALED = (
    "haptic.arrows", "haptic.arrows.idx", "haptic_columns.arrows", "parameters.arrows", "events.jsonl", "trials.csv",
    "session.json",
)  # fmt: skip
STATICS = "haptic_statics.npz"
FILES = (*SEALED, STATICS, "manifest.json", "trips/trip_000.arrows")

_RAW = (
    b"5", b'"x"', b"null", b"true", b"[]", b"{}", b"-1", b"1e308", b"1" + b"0" * 400, b"NaN", b"1e999", b'"\\ud800"',
    b'"\xff\xfe"', b"[" * 3000 + b"]" * 3000, b"[" * 400 + b"]" * 400, b'{"a":' * 90 + b"1" + b"}" * 90, b"9" * 5000,
    b'"' + b"y" * 200_000 + b'"', b"0.5", b"18446744073709551616", b"[[1,2],[3]]", b'{"":{"":null}}', b'"<script>"',
)  # fmt: skip
_NUMBERS = (np.nan, np.inf, -np.inf, 1e300, -1e300, -1.0, 0.5, 2.0**63, 1e18)


def copy_run(source: Path, target: Path) -> Path:
    """A fresh copy of a run folder, also over what a mutation left behind."""
    shutil.rmtree(target, ignore_errors=True)
    return Path(shutil.copytree(source, target))


def mutate(folder: Path, seed: int) -> str:
    """Damage the folder; what was done, in words."""
    chance = random.Random(seed)
    done = chance.choice(MUTATIONS)(folder, chance)
    return f"seed {seed}: {done}"


def _some_file(folder: Path, chance: random.Random) -> Path:
    return folder / chance.choice([name for name in FILES if (folder / name).exists()])


def flip_bits(folder: Path, chance: random.Random) -> str:
    path = _some_file(folder, chance)
    content = bytearray(path.read_bytes())
    places = [chance.randrange(len(content)) for _ in range(chance.choice((1, 1, 1, 3, 20)))]
    if chance.random() < 0.3:  # headers and schemas lie at the front
        places = [place % 4000 % len(content) for place in places]
    for place in places:
        content[place] ^= 1 << chance.randrange(8)
    path.write_bytes(content)
    return f"bits of {path.name} at {places} flipped"


def truncate(folder: Path, chance: random.Random) -> str:
    path = _some_file(folder, chance)
    size = chance.randrange(path.stat().st_size)
    os.truncate(path, size)
    return f"{path.name} cut to {size}"


def overwrite(folder: Path, chance: random.Random) -> str:
    """Zeros, other bytes, or a piece of the file itself, over it or between."""
    path = _some_file(folder, chance)
    content = path.read_bytes()
    place, length = chance.randrange(len(content)), chance.choice((1, 8, 100, 4096))
    start = chance.randrange(len(content))
    piece = chance.choice((bytes(length), chance.randbytes(length), content[start : start + length]))
    path.write_bytes(content[:place] + piece + content[place + chance.choice((0, length)) :])
    return f"{length} bytes of {path.name} at {place}"


def another_thing(folder: Path, chance: random.Random) -> str:
    """No file, an empty one, a folder, a FIFO, a link to a device or to nothing."""
    path = _some_file(folder, chance)
    what = chance.choice(("nothing", "empty", "folder", "fifo", "device", "dangling", "unreadable name"))
    path.unlink()
    if what == "empty":
        path.touch()
    elif what == "folder":
        path.mkdir()
    elif what == "fifo":
        os.mkfifo(path)
    elif what in ("device", "dangling"):
        path.symlink_to("/dev/zero" if what == "device" else folder / "not there")
    return f"{path.name} is {what}"


def exchange_value(folder: Path, chance: random.Random) -> str:
    """One value, or one name, of a JSON text becomes another."""
    name = chance.choice(("manifest.json", "session.json", "events.jsonl"))
    name = name if (folder / name).exists() else "session.json"
    path = folder / name
    lines = path.read_bytes().splitlines() if name == "events.jsonl" else [path.read_bytes()]
    at = chance.randrange(min(len(lines), 40))
    content = json.loads(lines[at])
    raw = chance.choice(_RAW)
    place = _put(content, "@@", chance)
    lines[at] = json.dumps(content).encode().replace(b'"@@"', raw)
    path.write_bytes(b"\n".join(lines) + b"\n")
    return f"{name} line {at} {place} is {raw[:30]!r}"


def _put(item: Any, value: str, chance: random.Random) -> str:
    keys = list(item) if isinstance(item, dict) else list(range(len(item)))
    if not keys:
        return "(empty)"
    key = chance.choice(keys)
    part = item[key]
    if isinstance(part, (dict, list)) and part and chance.random() < 0.7:
        return f"/{key}" + _put(part, value, chance)
    if isinstance(item, dict) and chance.random() < 0.2:
        item[f"{key}x"] = item.pop(key)
        return f"/{key} renamed"
    item[key] = value
    return f"/{key}"


def exchange_cell(folder: Path, chance: random.Random) -> str:
    path = folder / "trials.csv"
    rows = path.read_bytes().split(b"\n")
    at = chance.randrange(len(rows))
    cells = rows[at].split(b",")
    raw = chance.choice((*_RAW, b'"', b"a\rb", b"\0", b"", b"1,2", b"=cmd()", b"x" * 140_000))
    cells[chance.randrange(len(cells))] = raw
    rows[at] = b",".join(cells)
    path.write_bytes(b"\n".join(rows))
    return f"trials.csv row {at}: a cell is {raw[:30]!r}"


def forge_samples(folder: Path, chance: random.Random) -> str:
    """Rows that nobody measured, in a block whose checksum is right."""
    samples = Run.open(folder).haptic[100:150].copy()
    name = chance.choice(samples.dtype.names or ())
    number = chance.choice(_NUMBERS)
    samples[name][chance.randrange(50)] = number
    block = encode_samples(samples, 2, 100)
    path = folder / "haptic.arrows"
    _, offset, length = np.fromfile(folder / "haptic.arrows.idx", np.int64).reshape(-1, 3)[2].tolist()
    content = path.read_bytes()
    path.write_bytes(content[:offset] + block + content[offset + length :])
    return f"haptic.arrows: {name} is {number}"


def forge_parameters(folder: Path, chance: random.Random) -> str:
    """A parameter block of arbitrary bytes, its checksum right."""
    block = bytearray(packed(*scene_block(chance.choice((1, 2, 99)), 1, 0)))
    for _ in range(chance.choice((1, 10, 1000))):
        block[chance.randrange(8, SCENE.itemsize)] = chance.randrange(256)
    with (folder / "parameters.arrows").open("ab") as file:
        file.write(encode_parameters(bytes(block), chance.choice((4, 0, 2**62))))
    return "parameters.arrows: a forged block"


MUTATIONS: tuple[Callable[[Path, random.Random], str], ...] = (
    flip_bits,
    truncate,
    overwrite,
    another_thing,
    exchange_value,
    exchange_value,
    exchange_cell,
    forge_samples,
    forge_parameters,
)
