"""Rules that import-linter and ruff cannot see, read from the syntax trees."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from functools import cache

import pytest

from tests.architecture.sources import PACKAGE, ROOT, attributes, imports, modules, repository_files

KERNELS_MAY_IMPORT = (
    "__future__",
    "collections.abc",
    "enum",
    "math",
    "typing",
    "numba",
    "numpy",
    "mimics_app.maths",
    "mimics_app.contracts.atomics",
    "mimics_app.contracts.borrowed",
    "mimics_app.contracts.haptic",
    "mimics_app.contracts.haptic_objects",
    "mimics_app.contracts.kernel",
    "mimics_app.contracts.loop_fields",
    "mimics_app.contracts.loop_ports",
    "mimics_app.contracts.record_copy",
    "mimics_app.contracts.ring",
    "mimics_app.contracts.triple_buffer",
)
TIMEKEEPERS = {"contracts/clock.py", "contracts/atomics.py"}
CLOCKS = re.compile(
    r"(?:^|\.)(?:time\.(?:time|monotonic|perf_counter|process_time|thread_time)(?:_ns)?"
    r"|time\.(?:sleep|localtime|gmtime|strftime|clock_gettime)|datetime\.(?:now|utcnow|today)|date\.today)$"
)
IMPORTERS_BY_NAME = {"app/cli.py", "builders/catalogue.py"}
"""Modules that may import by a string: the command line, for its commands, and the builders, for their own packages."""

PLATFORM_HOMES = {
    "the shared memory": (
        re.compile(r"^(os\.memfd_create|shared_memory\.SharedMemory)$"),
        {"contracts/segment.py"},
    ),
    "the scheduler": (
        re.compile(r"^os\.(sched_set\w+|setpriority|nice)$"),
        {"rendering/haptic/scheduler.py", "rendering/audio/worker.py"},
    ),
    "the GL context": (
        re.compile(r"^moderngl\.(create_context|create_standalone_context|get_context)$"),
        {"rendering/visual/surfaces/contexts.py", "rendering/visual/surfaces/window.py"},
    ),
}


def _is_kernel(path: str) -> bool:
    return "kernels" in path.removesuffix(".py").split("/")


def _stage(path: str) -> str:
    """Dotted name of the package around a kernels package, e.g. mimics_app.rendering.haptic."""
    parts = path.removesuffix(".py").split("/")
    return ".".join(["mimics_app", *parts[: parts.index("kernels")]])


def _file_of(name: str) -> str | None:
    """The module a dotted name lies in, as a path; the name may end in something the module defines."""
    parts = name.split(".")[1:]
    return next((path for path in ("/".join(parts) + ".py", "/".join(parts[:-1]) + ".py") if path in modules()), None)


def _strangers(path: str, stage: str, seen: set[str]) -> Iterator[str]:
    """Imports a kernel must not have. Compiled helpers of its own stage pass when they keep the same rule."""
    seen.add(path)
    for line, name in imports(modules()[path]):
        if any(name == known or name.startswith(known + ".") for known in KERNELS_MAY_IMPORT):
            continue
        helper = _file_of(name) if name.startswith(stage + ".") else None
        if helper is None:
            yield f"{path}:{line} imports {name}"
        elif helper not in seen:
            yield from _strangers(helper, stage, seen)


@pytest.mark.parametrize("path", [path for path in modules() if _is_kernel(path)])
def test_kernels_import_only_what_is_allowed(path: str) -> None:
    assert not list(_strangers(path, _stage(path), set()))


@pytest.mark.parametrize("path", [path for path in modules() if path.endswith("__init__.py")])
def test_package_files_are_a_docstring_and_all(path: str) -> None:
    """Nothing is imported by importing a package: `mimics --help` passes through several of them."""
    tree = modules()[path]
    assert ast.get_docstring(tree), f"{path} has no docstring"
    assert not list(imports(tree)), f"{path} imports"
    names = {
        target.id
        for node in tree.body[1:]
        for target in (node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)])
        if isinstance(target, ast.Name)
    }
    assert "__all__" in names
    assert names <= {"__all__", "__version__"}


def test_every_folder_with_modules_is_a_package() -> None:
    folders = {file.parent for file in PACKAGE.rglob("*.py")}
    assert not [str(folder) for folder in folders if not (folder / "__init__.py").is_file()]


def test_only_the_clock_asks_for_the_time() -> None:
    asked = [
        f"{path}:{line} {name}"
        for path, tree in modules().items()
        if path not in TIMEKEEPERS
        for line, name in [*attributes(tree), *imports(tree)]
        if CLOCKS.search(name)
    ]
    assert not asked


def test_nothing_is_imported_by_a_string() -> None:
    """import-linter sees no `importlib.import_module("moderngl")`."""
    found = [
        f"{path}:{node.lineno}"
        for path, tree in modules().items()
        if path not in IMPORTERS_BY_NAME
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__", "exec"))
    ]
    assert not found


@pytest.mark.parametrize("what", PLATFORM_HOMES)
def test_the_platform_stands_behind_one_module(what: str) -> None:
    pattern, homes = PLATFORM_HOMES[what]
    found = {
        f"{path}:{line} {name}"
        for path, tree in modules().items()
        if path not in homes
        for line, name in attributes(tree)
        if pattern.match(name)
    }
    assert not found


@pytest.mark.parametrize("what", PLATFORM_HOMES)
def test_every_home_of_the_platform_is_a_module(what: str) -> None:
    """A home that moved would leave its name allowed for whatever comes there next."""
    assert PLATFORM_HOMES[what][1] <= set(modules())


@cache
def _classes() -> dict[str, ast.ClassDef]:
    nodes = [node for tree in modules().values() for node in ast.walk(tree)]
    return {node.name: node for node in nodes if isinstance(node, ast.ClassDef)}


def _inherits_docstring(owner: ast.ClassDef, method: str) -> bool:
    """Whether a base class of ours, at any height, documents this method."""
    for base in owner.bases:
        above = _classes().get(ast.unparse(base).split("[")[0].rsplit(".", 1)[-1])
        if above is None:
            continue
        if any(getattr(node, "name", "") == method and ast.get_docstring(node) for node in above.body):  # type: ignore[arg-type]
            return True
        if _inherits_docstring(above, method):
            return True
    return False


def _is_told_elsewhere(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> bool:
    """A setter has its getter's docstring, an @overload that of the function itself."""
    marks = [ast.unparse(mark).rsplit(".", 1)[-1] for mark in node.decorator_list]
    return "setter" in marks or "overload" in marks


def _undocumented(body: list[ast.stmt], owner: ast.ClassDef | None = None) -> Iterator[str]:
    for node in body:
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)) or node.name.startswith("_"):
            continue
        if _is_told_elsewhere(node):
            continue
        if not ast.get_docstring(node) and not (owner and _inherits_docstring(owner, node.name)):
            yield f"{node.name} (line {node.lineno})"
        if isinstance(node, ast.ClassDef):
            yield from _undocumented(node.body, node)


def test_everything_public_is_documented() -> None:
    """Functions, classes and methods; a method that overrides a documented one need not say it again."""
    bare = [f"{path}: {name}" for path, tree in modules().items() for name in _undocumented(tree.body)]
    bare += [path for path, tree in modules().items() if not ast.get_docstring(tree)]
    assert not bare, "\n".join(bare)


def test_every_module_says_what_it_offers() -> None:
    """`__all__` is there and names only what exists."""
    faults = []
    for path, tree in modules().items():
        defined = {getattr(node, "name", "") for node in ast.walk(tree)}
        defined |= {
            node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        }
        defined |= {name.rsplit(".", 1)[1] for _, name in imports(tree) if "." in name}
        offered = _offered(tree)
        if offered is None:
            faults.append(f"{path}: no __all__")
        else:
            faults += [f"{path}: {name} does not exist" for name in offered if name not in defined]
    assert not faults


def _offered(tree: ast.Module) -> list[str] | None:
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        if any(isinstance(target, ast.Name) and target.id == "__all__" for target in targets):
            value = getattr(node, "value", None)
            return [item.value for item in value.elts] if isinstance(value, (ast.List, ast.Tuple)) else []  # type: ignore[attr-defined]
    return None


def test_nothing_is_left_to_do() -> None:
    word = re.compile(r"\b(?:" + "|".join(["TO" + "DO", "FIX" + "ME", "X" + "XX", "HA" + "CK"]) + r")\b")
    found = [
        f"{file.relative_to(ROOT)}:{number}"
        for file in repository_files()
        for number, line in enumerate(file.read_text(encoding="utf-8", errors="replace").splitlines(), 1)
        if word.search(line)
    ]
    assert not found


def test_no_path_of_a_developer_machine() -> None:
    place = re.compile(r"(?<![\w./<{}$~])/(?:home|root|work|Users|mnt|opt)/[\w.-]+")
    found = [
        f"{file.relative_to(ROOT)}:{number} {hit.group()}"
        for file in repository_files()
        for number, line in enumerate(file.read_text(encoding="utf-8", errors="replace").splitlines(), 1)
        if (hit := place.search(line))
    ]
    assert not found


def _pins() -> list[str]:
    """The requirement lines with their hashes, one string each."""
    text = (ROOT / "requirements.txt").read_text(encoding="utf-8")
    lines = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    return [" ".join(pin.split()) for pin in lines.replace("\\\n", " ").splitlines() if pin.strip()]


def test_requirements_name_no_place() -> None:
    """Any registry will do: what is installed is decided by the hashes."""
    text = (ROOT / "requirements.txt").read_text(encoding="utf-8")
    assert "://" not in text
    assert not re.search(r"^\s*-|--(?:index|extra|find|trusted)", re.sub(r"--hash=", "", text), re.MULTILINE)
    assert not re.search(r"\b[\w-]+\.(?:org|com|net|io|dev)\b", text)
    assert not re.search(r"\s@\s", text)


def test_every_requirement_is_exact_and_hashed() -> None:
    for pin in _pins():
        assert re.match(r"^[a-z0-9._-]+==[\w.]+(?: ; .+?)?(?: --hash=sha256:[0-9a-f]{64})+$", pin), pin


def test_requirements_hold_what_pyproject_asks_for() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = [*project["project"]["dependencies"], *project["dependency-groups"]["dev"]]
    names = {re.split(r"[<>=!~ ;\[]", want)[0].lower().replace("_", "-") for want in wanted}
    pinned = {pin.split("==")[0] for pin in _pins()}
    assert names <= pinned
    assert not list(ROOT.glob("uv.lock")), "a lock file names a host for every file: requirements.txt is the lock"
