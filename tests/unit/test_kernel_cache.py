"""The kernel cache: every source a kernel can reach belongs to its key, and nobody else can put code into it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.contracts.system.resources import root

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A checkout of the sources that may be edited."""
    folder = tmp_path_factory.mktemp("checkout")
    shutil.copytree(root() / "mimics_app", folder / "mimics_app", ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def _run(code: str, folder: Path, **environment: str) -> str:
    """Output of a program. It writes no byte code: that of a source edited again within a second would pass for new."""
    done = subprocess.run(
        [sys.executable, "-B", "-c", code],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder)} | environment,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


_KEY = """
from pathlib import Path
import mimics_app
from mimics_app.compiled.kernel_sources import source_key
base = Path(mimics_app.__file__).resolve().parents[1]
for name in {names!r}:
    print(source_key(base / name))
"""

_EDIT_EACH = """
import re, sys
from mimics_app.compiled import kernel_sources as cache
from mimics_app.rendering.haptic import loop
from pathlib import Path

def key():
    for known in (cache._read, cache._imports, cache._digest, cache.source_key):
        known.cache_clear()
    return cache.source_key(root)

KEEPERS = ("cache_folder.py", "kernel_cache.py", "kernel_sources.py", "kernel_sweep.py", "private_folder.py")
root = Path(loop.__file__).resolve()
base = Path(cache.__file__).resolve().parents[2]
loaded = {Path(m.__file__).resolve() for m in list(sys.modules.values()) if getattr(m, "__file__", None)}
reached = cache.sources_reached(root)
print("reached", len(reached))
for file in sorted(loaded - set(reached)):
    if file.is_relative_to(base / "mimics_app") and file.name not in ("__init__.py", *KEEPERS):
        print("not in the key", file)
before = key()
for file in reached:
    text = file.read_text()
    number = re.search(r"^_?[A-Z][A-Z_0-9]*(?:: \\w+)? = [^\\n]*?\\b(\\d+)", text, re.MULTILINE)
    edited = text + "_PLANTED = 1" if number is None else text[: number.start(1)] + "7" + text[number.start(1) :]
    file.write_text(edited)
    print("constant" if number else "line", "seen" if key() != before else "UNSEEN", file)
    file.write_text(text)
print("back", key() == before)
"""


@pytest.mark.seconds
def test_an_edit_of_a_constant_in_any_source_the_loop_reaches_changes_its_key(copied: Path) -> None:
    """The files are those that the loop's imports reach, and no module that its import loads is missing among them."""
    lines = _run(_EDIT_EACH, copied).splitlines()
    assert not [line for line in lines if "not in the key" in line or "UNSEEN" in line]
    seen = [line for line in lines if "seen" in line]
    assert lines[0] == f"reached {len(seen)}" and len(seen) > 40
    assert sum(line.startswith("constant") for line in seen) > 30
    for known in (
        "contracts/loop/haptic.py",
        "compiled/atomics.py",
        "contracts/loop/haptic_objects.py",
        "compiled/borrowed.py",
    ):
        assert any(line.endswith(known) for line in seen), known
    assert lines[-1] == "back True"


def test_an_edit_leaves_alone_what_does_not_import_it(copied: Path) -> None:
    names = ["mimics_app/rendering/haptic/kernels/friction.py", "mimics_app/rendering/haptic/kernels/kinematics.py"]
    code = _KEY.format(names=names)
    before = _run(code, copied).split()
    file = copied / names[0]
    file.write_bytes(file.read_bytes() + b"\n_PLANTED = 1\n")
    after = _run(code, copied).split()
    assert after[0] != before[0] and after[1] == before[1]


_PROBE = """
from mimics_app.compiled.kernel import kernel
from plugged.constants import ANSWER

@kernel
def answer(x):
    return x + ANSWER
"""


@pytest.mark.seconds
def test_a_constant_of_another_file_takes_effect_in_the_next_process(tmp_path: Path) -> None:
    """numba's own cache fails this: it looks at the file of the compiled function only."""
    package = tmp_path / "plugged"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "kernels.py").write_text(_PROBE)
    code = "from plugged.kernels import answer; print(answer(0), sum(answer.stats.cache_hits.values()));"
    code += "import sys; print('numba.np.npyimpl' in sys.modules)"
    seen = []
    for value in (1, 1, 2):
        (package / "constants.py").write_text(f"ANSWER = {value}\n")
        seen.append(_run(code, tmp_path, PYTHONPATH=f"{tmp_path}:{ROOT}", NUMBA_CACHE_DIR=str(tmp_path / "cache")))
    assert seen == ["1 0\nTrue", "1 1\nFalse", "2 0\nTrue"], "what is kept is loaded without the whole compiler"


_CALLS_ITSELF = """
from mimics_app.compiled.kernel import kernel

@kernel
def factorial(n):
    if n <= 0:
        return 1
    return n * factorial(n - 1)
"""


@pytest.mark.seconds
def test_a_function_that_calls_itself_is_kept_with_its_intermediate_code(tmp_path: Path) -> None:
    (tmp_path / "recursive.py").write_text(_CALLS_ITSELF)
    code = "from recursive import factorial; print(factorial(5), sum(factorial.stats.cache_hits.values()))"
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert [_run(code, tmp_path, **places) for _ in range(2)] == ["120 0", "120 1"]


def test_relative_and_parenthesised_imports_are_followed(tmp_path: Path) -> None:
    package = tmp_path / "relative_plugin"
    (package / "inner").mkdir(parents=True)
    for name in ("__init__.py", "inner/__init__.py", "leaf.py", "inner/twig.py"):
        (package / name).write_text("")
    (package / "inner" / "kernels.py").write_text(
        "from ..leaf import (  # a remark\n    A,\n    B as C,\n)\nfrom . import twig\n"
    )
    code = (
        "from pathlib import Path; from mimics_app.compiled.kernel_sources import sources_reached;"
        f"print(*[f.name for f in sources_reached(Path({str(package / 'inner' / 'kernels.py')!r}))])"
    )
    assert _run(code, tmp_path, PYTHONPATH=f"{tmp_path}:{ROOT}") == "kernels.py twig.py leaf.py"


@pytest.mark.seconds
def test_a_damaged_or_foreign_file_is_compiled_again(tmp_path: Path) -> None:
    package = tmp_path / "plugged"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "constants.py").write_text("ANSWER = 5\n")
    (package / "kernels.py").write_text(_PROBE)
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    elsewhere = "source = open('plugged/kernels.py').read(); names = {'__name__': 'nowhere_to_be_found'};"
    elsewhere += "exec(compile(source, 'plugged/kernels.py', 'exec'), names); print(names['answer'](0))"
    here = "from plugged.kernels import answer; print(answer(0))"
    assert _run(elsewhere, tmp_path, **places) == _run(here, tmp_path, **places) == "5"
    for pattern in ("*.nbc", "*.nbi"):
        for kept in (tmp_path / "cache").rglob(pattern):
            kept.write_bytes(kept.read_bytes()[:60])
        assert _run(here, tmp_path, **places) == "5"
    for kept in (tmp_path / "cache").rglob("*.nbi"):
        damaged = kept.read_bytes().replace(b"numba", b"numb\xe1")  # no text of UTF-8 any more
        assert damaged != kept.read_bytes()
        kept.write_bytes(damaged)
    assert _run(here, tmp_path, **places) == "5"


@pytest.mark.seconds
def test_one_bit_of_the_machine_code_costs_a_compilation(tmp_path: Path) -> None:
    """It would otherwise run: a file that lost a page with the power is read without an error."""
    (tmp_path / "probe.py").write_text(_TWO)
    code = "import probe; print(probe.answer(2), sum(probe.answer.stats.cache_hits.values()))"
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert [_run(code, tmp_path, **places) for _ in range(2)] == ["7 0", "7 1"]
    for stored in (tmp_path / "cache").rglob("*.nbc"):
        content = bytearray(stored.read_bytes())
        content[len(content) // 2] ^= 1
        stored.write_bytes(content)
    assert [_run(code, tmp_path, **places) for _ in range(2)] == ["7 0", "7 1"]


@pytest.mark.seconds
def test_a_cache_on_a_full_disk_is_none(tmp_path: Path) -> None:
    (tmp_path / "probe.py").write_text(_FULL)
    for _ in range(2):
        places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        assert _run("import probe; print(probe.answer(2))", tmp_path, **places) == "7"


_TWO = """
from mimics_app.compiled.kernel import kernel
@kernel
def inner(x):
    return x + 1
@kernel
def answer(x):
    return inner(x) + 4
"""

_FULL = f"""
import resource
{_TWO}
resource.setrlimit(resource.RLIMIT_FSIZE, (200, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
"""


# --- kernels that only kernels call ----------------------------------------------------------------------------------

_CHAIN = """
import numpy as np
from mimics_app.compiled.kernel import kernel

@kernel
def inner(x):
    return x * 2.0

@kernel
def outer(x):
    return inner(x) + 1.0

print(outer(3.0), len(outer.signatures), len(inner.signatures))
"""


_CONSTANTS = """
from mimics_app.compiled.kernel import kernel

@kernel
def shifted(x, by):
    return x + by

@kernel
def member(pair, place):
    return pair[place]

@kernel
def outer(x):
    return shifted(x, 1) + shifted(x, 2) + shifted(x, by=4) + member((x, True), 0)

print(outer(3))
"""


@pytest.mark.seconds
def test_constants_are_no_types_unless_a_function_needs_them(tmp_path: Path) -> None:
    """The place in a tuple of two types is one it needs."""
    (tmp_path / "constants_of.py").write_text(_CONSTANTS)
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert _run("import constants_of", tmp_path, **places) == "19"
    assert len(list((tmp_path / "cache").rglob("linked-*shifted*.nbc"))) == 1


@pytest.mark.seconds
def test_a_kernel_that_only_kernels_call_never_becomes_machine_code(tmp_path: Path) -> None:
    """Its file holds intermediate code, and the next process links from there; called from Python it is compiled."""
    (tmp_path / "chain.py").write_text(_CHAIN + "print(inner(4.0))\n")
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    for _ in range(2):
        assert _run("import chain", tmp_path, **places).split("\n") == ["7.0 1 0", "8.0"]
    names = sorted(path.name for path in (tmp_path / "cache").rglob("*.nbi"))
    assert [name.split("-")[0] for name in names] == ["chain.inner", "chain.outer", "linked"]


@pytest.mark.seconds
def test_an_edit_after_the_start_keeps_the_old_code_out_of_the_cache(tmp_path: Path) -> None:
    source = tmp_path / "chain.py"
    source.write_text(_CHAIN.replace("print(", "0 and print("))
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    edit = "from pathlib import Path; p = Path(chain.__file__); p.write_text(p.read_text().replace('2.0', '5.0'))"
    assert _run(f"import chain; {edit}; print(chain.outer(3.0))", tmp_path, **places) == "7.0"
    assert _run("import chain; print(chain.outer(3.0))", tmp_path, **places) == "16.0"


_DOUBLES = """
from mimics_app.compiled.kernel import kernel

@kernel
def doubled(x):
    return x + x
"""


@pytest.mark.seconds
def test_two_processes_that_first_compile_one_function_for_other_types_take_each_their_own(tmp_path: Path) -> None:
    """numba numbers the files by an index that it read before: the later process writes over the earlier one's code."""
    (tmp_path / "doubles.py").write_text(_DOUBLES)
    places = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    whole, real = (f"from doubles import doubled; print(doubled({number}))" for number in ("3", "2.25"))
    assert _run(whole, tmp_path, **places) == "6"
    (index,) = tmp_path.glob("cache/**/doubles.doubled-*.nbi")
    of_whole = index.read_bytes()
    index.unlink()
    assert _run(real, tmp_path, **places) == "4.5"
    index.write_bytes(of_whole)
    assert _run(whole, tmp_path, **places) == "6"
