"""`python -m tests.planted`: plant each fault in a copy, run its test, and tell which faults no test noticed.

The copy is what git tracks or would track. First every named test runs there as it stands: one that is red anyway
would "find" each fault. Machine code of changed kernels goes into a cache of the copy, begun with the user's own.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from mimics_app.compiled.private_folder import private_folder
from tests.planted.faults import ROOT, PlantedFault, read_faults

_RED, _GREEN = 1, 0
"""Exit statuses of pytest; any other says that the test did not run (a fault that cannot even be imported)."""

_TIMEOUT_S = 900.0
"""Longest time of one test: a changed kernel and all its callers may have to be compiled on a busy machine."""


def _copy_tree(folder: Path) -> Path:
    """Copy what belongs to the repository."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    copy = folder / "tree"
    for name in filter(None, listed.stdout.decode().split("\0")):
        if (source := ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, copy / name)
    return copy


def _own_cache(folder: Path) -> Path:
    """Copy the user's kernels, so that only what a fault changes is compiled."""
    cache = folder / "cache"
    if (kept := private_folder()) is not None:
        shutil.copytree(kept, cache / "mimics", ignore=shutil.ignore_patterns("*.lock"))
    return cache


def _run(copy: Path, tests: Sequence[str], *, told: bool = False) -> int:
    """Run tests in the copy; return pytest's exit status, or -1 after the longest time of a fault.

    Args:
        copy: Folder of the copy.
        tests: Node ids.
        told: Whether pytest's output is shown, and the time has no end.
    """
    environment = os.environ | {"PYTHONPATH": str(copy), "NUMBA_CACHE_DIR": str(copy.parent / "cache")}
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-n0", "-p", "no:cacheprovider", *tests]
    try:
        return subprocess.run(
            command,
            cwd=copy,
            env=environment,
            stdout=sys.stderr if told else subprocess.DEVNULL,
            stderr=None if told else subprocess.DEVNULL,
            timeout=None if told else _TIMEOUT_S,
        ).returncode
    except subprocess.TimeoutExpired:
        return -1


def _plant_and_run(copy: Path, fault: PlantedFault) -> int:
    path = copy / fault.file
    source = path.read_text(encoding="utf-8")
    path.write_text(fault.plant(source), encoding="utf-8")
    try:
        return _run(copy, [fault.test])
    finally:
        path.write_text(source, encoding="utf-8")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make planted", description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--only", metavar="WORD", help="faults whose room or name has this word")
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    return parser.parse_args()


def main() -> int:
    """Return 0 when every fault was noticed, 1 when one survived or a test was red before, 2 without a fault."""
    options = _options()
    faults = [fault for fault in read_faults() if (options.only or "") in f"{fault.room} {fault.name}"]
    if not faults:
        print(f"make planted: no fault has the word {options.only!r}", file=sys.stderr)
        return 2
    begin, survivors = time.monotonic(), []
    with tempfile.TemporaryDirectory(prefix="mimics-planted-") as name:
        copy = _copy_tree(Path(name))
        _own_cache(Path(name))
        if _run(copy, sorted({fault.test for fault in faults}), told=True) != _GREEN:
            print("make planted: a named test is red without any fault; run make test first", file=sys.stderr)
            return 1
        for fault in faults:
            status = _plant_and_run(copy, fault)
            if status != _RED:
                survivors.append({"room": fault.room, "name": fault.name, "test": fault.test, "status": status})
            if not options.json:
                print(
                    f"{'killed  ' if status == _RED else f'SURVIVED ({status})'} {fault.room}: {fault.name}", flush=True
                )
    report = {
        "planted": len(faults),
        "killed": len(faults) - len(survivors),
        "survivors": survivors,
        "minutes": round((time.monotonic() - begin) / 60.0, 1),
    }
    print(json.dumps(report))
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
