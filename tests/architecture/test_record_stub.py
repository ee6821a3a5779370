"""Kernels are typed: the stub of records is what the dtypes say, and a wrong field in a kernel is seen by mypy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.record_stub import STUB, stub_text

PLANTED = """
from __future__ import annotations
from typing import TYPE_CHECKING
from mimics_app.contracts.kernel import kernel
if TYPE_CHECKING:
    from mimics_app.contracts.record_types import BodyRecord, Floats, Table


@kernel
def law(bodies: Table[BodyRecord], out: Floats) -> float:
    {line}
    return bodies[0].mass
"""


def test_the_stub_is_what_the_dtypes_say() -> None:
    assert STUB.read_text(encoding="utf-8") == stub_text(), "write it anew: python -m tests.architecture.record_stub"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("out[0] = bodies[0].mass * 2.0", ""),
        ("out[0] = bodies[0].mas", '"BodyRecord" has no attribute "mas"'),
        ("bodies[0].flags = 0.5", "Incompatible types in assignment"),
        ("law(out, out)", "incompatible type"),
    ],
)
def test_mypy_sees_into_kernels(tmp_path: Path, line: str, said: str) -> None:
    file = tmp_path / "planted.py"
    file.write_text(PLANTED.format(line=line))
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(STUB.parents[2] / ".mypy_cache"), str(file)]
    done = subprocess.run(command, cwd=STUB.parents[2], capture_output=True, text=True, check=False)
    assert said in done.stdout and done.returncode == int(bool(said)), done.stdout
