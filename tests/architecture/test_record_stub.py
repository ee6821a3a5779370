"""Kernels are typed: the stub of records is what the dtypes say, and a wrong field in a kernel is seen by mypy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.architecture.record_stub import ROOT, STUBS, stub_text

PLANTED = """
from __future__ import annotations
from typing import TYPE_CHECKING
from mimics_app.compiled.kernel import kernel
if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import BodyRecord, Floats, Table


@kernel
def law(bodies: Table[BodyRecord], out: Floats) -> float:
    out[0] = bodies[0].mass * 2.0
    out[1] = bodies[0].mas
    bodies[0].flags = 0.5
    law(bodies[0], out)
    return bodies[0].mass
"""
"""One line that is right, then three that are not."""

SAID = {12: '"BodyRecord" has no attribute "mas"', 13: "Incompatible types in assignment", 14: "incompatible type"}
"""Line -> what mypy says of it."""


def test_the_stub_is_what_the_dtypes_say() -> None:
    for stub in STUBS:
        assert stub.read_text(encoding="utf-8") == stub_text(stub), (
            "write it anew: python -m tests.architecture.record_stub"
        )


def test_mypy_sees_into_kernels(tmp_path: Path) -> None:
    file = tmp_path / "planted.py"
    file.write_text(PLANTED)
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(ROOT / ".mypy_cache"), str(file)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    errors = [line.split(":", 2) for line in done.stdout.splitlines() if ": error:" in line]
    found = {int(number): text for _, number, text in errors}
    assert set(found) == set(SAID) and all(said in found[line] for line, said in SAID.items()), done.stdout
