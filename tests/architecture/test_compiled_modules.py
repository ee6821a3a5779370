"""Compiled modules know arrays and each other: an allow-list of imports for every module that compiles anything."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache

import pytest

from tests.architecture.sources import imports, modules, texts

KERNELS_MAY_IMPORT = (
    "__future__",
    "collections.abc",
    "enum",
    "math",
    "typing",
    "numba",
    "numpy",
    "mimics_app.maths",
    "mimics_app.contracts.arrays",
    "mimics_app.compiled.atomics",
    "mimics_app.compiled.borrowed",
    "mimics_app.compiled.function_pointers",
    "mimics_app.contracts.loop.controller_port",
    "mimics_app.contracts.loop.controller_slots",
    "mimics_app.contracts.loop.device_descriptor",
    "mimics_app.contracts.loop.gait_state",
    "mimics_app.contracts.loop.hard_object_kind",
    "mimics_app.contracts.loop.haptic",
    "mimics_app.contracts.loop.haptic_objects",
    "mimics_app.compiled.kernel",
    "mimics_app.contracts.loop.loop_fields",
    "mimics_app.contracts.loop.loop_ports",
    "mimics_app.contracts.loop.reference_rows",
    "mimics_app.contracts.loop.spoiling",
    "mimics_app.compiled.record_copy",
    "mimics_app.rendering.haptic.record_types",  # a stub: no module at run time
    "mimics_app.dsp.record_types",  # likewise
    "mimics_app.contracts.shared_memory.ring",
    "mimics_app.contracts.shared_memory.shared_words",
    "mimics_app.contracts.shared_memory.sound_scene",
    "mimics_app.contracts.shared_memory.triple_buffer",
)
"""What every compiled module may import, in a package named kernels or not."""

COMPILERS = {
    "mimics_app.compiled.kernel.kernel",
    "mimics_app.compiled.kernel.typed_kernel",
    "numba.cfunc",
    "numba.guvectorize",
    "numba.jit",
    "numba.njit",
    "numba.vectorize",
    "numba.extending.intrinsic",
    "numba.extending.overload",
}
"""Who imports one of these compiles."""

HOST = ("dataclasses", "functools", "mimics_app.contracts.loop.object_rows")
"""What a compiled module outside of a package named kernels may import, too: it also has a side in Python, which makes
the arrays that its compiled functions are given."""

_DESCRIPTORS = "mimics_app.compiled.file_descriptors"
_ERRORS = "mimics_app.contracts.errors"
_SCENE_BLOCK = "mimics_app.rendering.haptic.scene_block"
_LANES = "mimics_app.rendering.audio.spectral.lanes"
_DEVICES = "mimics_app.rendering.haptic.devices"

DEVIATIONS: dict[str, tuple[tuple[str, ...], str]] = {
    "compiled/atomics.py": (("llvmlite.ir", "time"), "writes the instructions itself; the clock is the one of `time`"),
    "compiled/file_descriptors.py": (("os", "select"), "numbers of the system's calls on descriptors"),
    "compiled/kernel.py": (
        ("mimics_app.compiled.cache_folder", "mimics_app.compiled.kernel_callee", "warnings"),
        "makes the compiler of all others",
    ),
    "compiled/record_copy.py": (("llvmlite.ir",), "writes the instructions itself"),
    "lab/probe.py": (("mimics_app.contracts.clock",), "times what it calls"),
    "rendering/audio/spectral/bins.py": ((_LANES, "llvmlite.ir"), "writes the instructions itself"),
    "rendering/audio/spectral/cell_kernels.py": ((_LANES,), "how long a row is"),
    "rendering/audio/spectral/fourier.py": ((_LANES,), "writes the instructions itself"),
    "rendering/haptic/publish.py": (("mimics_app.rendering.haptic.channels",), "the type of its channels"),
    "rendering/haptic/struck.py": (
        ("mimics_app.rendering.haptic.channels", "mimics_app.contracts.loop.contact_force"),
        "the types of its channels and of what it publishes",
    ),
    "rendering/haptic/devices/device_bench.py": ((_ERRORS,), "refuses a device in words"),
    "rendering/haptic/devices/emulators/hapticmaster_machine.py": ((_DEVICES,), "built from a robot's request"),
    "rendering/haptic/devices/hapticmaster_loop.py": ((_DESCRIPTORS, _DEVICES), "reads and writes a socket"),
    "rendering/haptic/devices/link.py": ((_ERRORS, "contextlib", "threading"), "opens and watches a link"),
    "rendering/haptic/devices/pointer.py": ((_DEVICES,), "built from a robot's request"),
    "rendering/haptic/devices/replay.py": ((_ERRORS, _DEVICES), "built from a robot's request"),
    "rendering/haptic/devices/serial_robot.py": ((_DESCRIPTORS, _DEVICES), "reads and writes a serial line"),
    "rendering/haptic/devices/simulated_hapticmaster.py": ((_DEVICES,), "built from a robot's request"),
    "rendering/haptic/devices/simulated_impedance.py": ((_DEVICES,), "built from a robot's request"),
    "rendering/haptic/devices/simulated_leg.py": ((_DEVICES, _ERRORS), "built from a robot's request"),
    "rendering/haptic/devices/simulated_lokomat.py": (
        (_DEVICES, _ERRORS, "mimics_app.rendering.haptic.descriptors"),
        "built from a robot's request",
    ),
    "rendering/haptic/devices/simulated_person.py": ((_DEVICES,), "built from a robot's request"),
    "rendering/haptic/live_loop.py": (
        ("mimics_app.contracts.shared_memory.session_memory", "mimics_app.rendering.haptic.channels"),
        "the words of control and the types of its channels",
    ),
    "rendering/haptic/loop.py": (
        ("mimics_app.contracts.shared_memory.session_memory", "mimics_app.rendering.haptic.channels"),
        "the words of control and the types of its channels",
    ),
    "rendering/haptic/loop_tick.py": (
        ("mimics_app.contracts.shared_memory.session_memory", "mimics_app.rendering.haptic.channels"),
        "the words of control and the types of its channels",
    ),
    "rendering/haptic/replay_loop.py": (
        ("mimics_app.rendering.haptic.channels",),
        "the words of control and the types of its channels",
    ),
    "world/files/simplify/edge_collapse.py": (("heapq",), "a queue of edges beside the compiled costs"),
    "lab/": (
        (
            "pathlib",
            "mimics_app.contracts",
            "mimics_app.lab",
            "mimics_app.rendering.haptic",
            "mimics_app.world.components.robot",
        ),
        "measures the product's compiled functions from compiled loops",
    ),
}
"""Path or folder -> what is imported beyond the rule, and why."""


def _is_kernel(path: str) -> bool:
    return "kernels" in path.removesuffix(".py").split("/")


@cache
def _compiled() -> tuple[str, ...]:
    """Paths of the modules that compile a function."""
    return tuple(path for path, tree in modules().items() if COMPILERS & {name for _, name in imports(tree)})


def _stage(path: str) -> str:
    """Dotted name of the stage a module belongs to, e.g. mimics_app.rendering.haptic; of other kernels: around them."""
    parts = path.removesuffix(".py").split("/")
    end = 2 if parts[0] == "rendering" else parts.index("kernels") if "kernels" in parts else 1
    return ".".join(["mimics_app", *parts[:end]])


def _file_of(name: str) -> str | None:
    """The module a dotted name lies in, as a path; the name may end in something the module defines."""
    parts = name.split(".")[1:]
    return next((path for path in ("/".join(parts) + ".py", "/".join(parts[:-1]) + ".py") if path in modules()), None)


def _is_in(name: str, allowed: tuple[str, ...]) -> bool:
    return any(name == known or name.startswith(known + ".") for known in allowed)


def _strangers(path: str, stage: str, seen: set[str], allowed: tuple[str, ...] = KERNELS_MAY_IMPORT) -> Iterator[str]:
    """Imports a kernel must not have. Compiled helpers of its own stage pass when they keep the same rule."""
    seen.add(path)
    for line, name in imports(modules()[path]):
        if _is_in(name, allowed):
            continue
        helper = _file_of(name) if name.startswith(stage + ".") else None
        if helper is None:
            yield f"{path}:{line} imports {name}"
        elif helper not in seen:
            yield from _strangers(helper, stage, seen, allowed)


def _excused(path: str) -> tuple[str, ...]:
    return tuple(name for place, (names, _) in DEVIATIONS.items() if path.startswith(place) for name in names)


def _foreign(path: str, tree: ast.Module) -> Iterator[str]:
    """Imports of a compiled module outside of kernels that neither the rule nor a deviation allows.

    A module of its own stage passes when it compiles something, and so is looked at on its own, or keeps the rule.
    """
    allowed = (*KERNELS_MAY_IMPORT, *HOST)
    for line, name in imports(tree):
        if _is_in(name, (*allowed, *_excused(path))):
            continue
        helper = _file_of(name) if name.startswith(_stage(path) + ".") else None
        if helper in _compiled() or (helper and not list(_strangers(helper, _stage(path), set(), allowed))):
            continue
        yield f"{path}:{line} imports {name}"


@pytest.mark.parametrize("path", [path for path in texts() if _is_kernel(path)])
def test_kernels_import_only_what_is_allowed(path: str) -> None:
    assert not list(_strangers(path, _stage(path), set()))


def _may_compile() -> list[str]:
    """Paths of the modules outside of kernels whose text names a compiler at all."""
    names = re.compile(r"\bnumba\b|\bcompiled\.kernel\b")
    return [path for path, text in texts().items() if not _is_kernel(path) and names.search(text)]


@pytest.mark.parametrize("path", _may_compile())
def test_compiled_modules_outside_of_kernels_import_only_what_is_allowed(path: str) -> None:
    assert path not in _compiled() or not list(_foreign(path, modules()[path]))


def test_no_compiled_module_is_left_out_of_the_test_above() -> None:
    assert {path for path in _compiled() if not _is_kernel(path)} <= set(_may_compile())


def test_the_loop_the_laws_and_the_devices_are_among_the_compiled_modules() -> None:
    """Otherwise the test above would look at nothing."""
    assert {
        "rendering/haptic/loop.py",
        "rendering/haptic/publish.py",
        "rendering/haptic/simulate.py",
        "rendering/haptic/control/joint_pd.py",
        "rendering/haptic/devices/serial_robot.py",
        "maths/quat.py",
        "world/graph/propagation.py",
    } <= set(_compiled())


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("rendering/haptic/loop.py", "import json"),
        ("rendering/haptic/control/joint_pd.py", "from mimics_app.world.components.robot import Robot"),
        ("rendering/haptic/simulate.py", "from mimics_app.rendering.haptic.engine import HapticEngine"),
        ("rendering/haptic/devices/serial_robot.py", "import pyarrow"),
        ("lab/stability/stack.py", "import moderngl"),
    ],
)
def test_a_planted_import_is_seen(path: str, line: str) -> None:
    assert list(_foreign(path, ast.parse(line)))


@pytest.mark.parametrize("place", DEVIATIONS)
def test_every_deviation_is_needed(place: str) -> None:
    """One that is left over would excuse whatever comes there next."""
    used = [name for path in _compiled() if path.startswith(place) for _, name in imports(modules()[path])]
    names, why = DEVIATIONS[place]
    assert why
    assert not [name for name in names if not any(_is_in(one, (name,)) for one in used)]


def _untyped(tree: ast.Module) -> list[str]:
    """Parameters and results of compiled functions that are annotated with `Any`, alone or inside of a type."""
    kernels = (
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        and any(ast.unparse(mark).split("(")[0] in ("kernel", "typed_kernel") for mark in node.decorator_list)
    )
    annotations = (
        (f"{node.name}: {name}", annotation)
        for node in kernels
        for name, annotation in (
            *((one.arg, one.annotation) for one in [*node.args.args, *node.args.kwonlyargs]),
            ("return", node.returns),
        )
        if annotation is not None
    )
    return [name for name, note in annotations if "Any" in {getattr(node, "id", "") for node in ast.walk(note)}]


def test_every_parameter_of_a_compiled_function_is_typed() -> None:
    """Records by the stubs `record_types.pyi`, functions handed over by their signatures."""
    untyped = {path: _untyped(tree) for path, tree in modules().items()}
    assert not {path: names for path, names in untyped.items() if names}


def test_a_planted_any_in_a_signature_is_found() -> None:
    planted = "@kernel\ndef law(state: Any, depth: float, rows: tuple[Any, int]) -> Any: ...\ndef plain(x: Any): ..."
    assert _untyped(ast.parse(planted)) == ["law: state", "law: rows", "law: return"]
