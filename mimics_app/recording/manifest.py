"""manifest.json: the last file of a run. It says how the run ended and seals the others with their SHA-256."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import msgspec

from mimics_app.contracts.regular_file import open_regular, read_regular
from mimics_app.recording.json_text import parse_object
from mimics_app.recording.run_folder import FILES, write_atomically

__all__ = ["Manifest", "Seal", "hash_files", "read_manifest", "write_manifest"]

_SEALED = ("haptic", "index", "parameters", "statics", "signals", "events", "trials", "session")


@dataclass(frozen=True, slots=True)
class Seal:
    """SHA-256 of a file, 64 hexadecimal digits, and its length in bytes."""

    sha256: str
    bytes: int


@dataclass(frozen=True, slots=True)
class Manifest:
    """How a run ended.

    Attributes:
        status: "clean" when the app closed it, "interrupted" when the app died and the recorder finished alone,
            "recovered" when `mimics record recover` sealed what it found.
        state_hash: See `StateHash`; of what stands in the files.
        rows, events, trials, parameters: How many samples, loop events, finished trials, parameter blocks are stored.
        dropped: Samples, loop events and journal messages that found no room.
        restarts: How often the recorder process was replaced.
        gaps: What is missing: dicts with `reason`, `rows` and, where known, `after_tick`.
        problem: The last trouble with the disk, "" for none.
        summary: What the app said at the end: the object of `mimics run --json`, and more.
        clock: Wall and monotonic time at the end.
        files: The seal of each file by its name.
        lost: What `mimics record recover` found missing or damaged, one sentence each.
        version: Of this format.
    """

    status: Literal["clean", "interrupted", "recovered"]
    state_hash: str
    rows: int
    events: int
    trials: int
    parameters: int
    dropped: dict[str, int] = field(default_factory=dict)
    restarts: int = 0
    gaps: list[dict[str, Any]] = field(default_factory=list)
    problem: str = ""
    summary: dict[str, Any] = field(default_factory=dict)
    clock: dict[str, Any] = field(default_factory=dict)
    files: dict[str, Seal] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    version: int = 1


def hash_files(folder: Path) -> dict[str, Seal]:
    """The seal of every file a manifest seals and that is there, by its name."""
    sealed: dict[str, Seal] = {}
    trips = sorted(path.relative_to(folder).as_posix() for path in folder.glob("trips/*.arrows"))
    for name in (*(FILES[key] for key in _SEALED), *trips):
        try:
            with open_regular(folder / name) as file:
                digest = hashlib.file_digest(file, "sha256")
                sealed[name] = Seal(digest.hexdigest(), file.tell())
        except OSError:
            continue
    return sealed


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write manifest.json in one step."""
    write_atomically(folder / FILES["manifest"], msgspec.json.format(msgspec.json.encode(manifest), indent=1))


def read_manifest(folder: Path) -> tuple[Manifest | None, str]:
    """The manifest of a run, and why there is none: "" where the run was never closed."""
    try:
        return msgspec.convert(parse_object(read_regular(folder / FILES["manifest"])), Manifest), ""
    except FileNotFoundError:
        return None, ""
    except OSError as error:
        return None, error.strerror or str(error)
    except (ValueError, RecursionError) as error:
        return None, str(error)
