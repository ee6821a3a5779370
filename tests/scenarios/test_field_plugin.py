"""Another force field is another function only: the loop's machine code stays what it was."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

_PLUGIN = """
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.loop_ports import FIELD

@typed_kernel(FIELD)
def push(parameters, p, v, t, out):
    out[0] = {force}
"""

_RUN = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import plugin_{force} as plugin
import mimics_app as mimics
from mimics_app.rendering.haptic.force_fields import add_field
from mimics_app.rendering.haptic.loop import advance_ticks
from mimics_app.rendering.haptic.simulate import simulate_objects
from tests.support.object_scenes import thing, written

add_field("push", plugin.push)
file = written(Path(sys.argv[1]), thing("robot", robot={{}}), thing("f", force_field={{"function": "push"}}))
with mimics.open(file, record="memory") as session:
    session.step(0.1)
print(session.haptic["f_effects"][-1, 0])
for function in (advance_ticks, simulate_objects):
    print(len(function.signatures), sum(function.stats.cache_misses.values()))
"""


@pytest.mark.parametrize("force", [1, 2])
def test_loop_is_taken_from_the_cache_whatever_field_is_plugged_in(tmp_path: Path, force: int):
    """The first start may compile it (unless another test did); the second, with another field, must not."""
    (tmp_path / f"plugin_{force}.py").write_text(_PLUGIN.format(force=f"{force}.0"), encoding="utf-8")
    program = _RUN.format(force=force)
    first = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, check=True)
    felt, *counts = first.stdout.split("\n")[:3]
    assert float(felt) == force
    if force == 2:
        assert counts == ["1 0", "1 0"], "compiled anew"
