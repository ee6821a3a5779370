"""Rules that import-linter and ruff cannot see, read from the syntax trees."""

from __future__ import annotations

import ast
import json
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import mimics_app
from tests.architecture.sources import (
    BUILDERS,
    PACKAGE,
    ROOT,
    attributes,
    imports,
    modules,
    nodes,
    repository_files,
    texts,
)
from tests.support.order import LONGEST

TIMEKEEPERS = {"contracts/clock.py", "compiled/atomics.py", "compiled/kernel_sources.py"}
CLOCKS = re.compile(
    r"(?:^|\.)(?:time\.(?:time|monotonic|perf_counter|process_time|thread_time)(?:_ns)?"
    r"|time\.(?:sleep|localtime|gmtime|strftime|clock_gettime)|datetime\.(?:now|utcnow|today)|date\.today)$"
)
IMPORTERS_BY_NAME = {
    "app/cli.py",
    "app/play/script_reload.py",
    "contracts/ports/members.py",
    "rendering/visual/surfaces/rasteriser.py",
}
"""Modules that may import by a string: the command line, for its commands, the reload of a script, the finder of a
package's members, and the seam to drawing in software, which only some drivers need."""

PLATFORM_HOMES = {
    "the shared memory": (
        re.compile(r"^(os\.memfd_create|shared_memory\.SharedMemory)$"),
        {"contracts/shared_memory/segment.py"},
    ),
    "the scheduler": (
        re.compile(r"^os\.(sched_set\w+|setpriority|nice)$"),
        {
            "console/page_server.py",
            "rendering/haptic/scheduler.py",
            "rendering/audio/long_sounds.py",
            "rendering/audio/worker.py",
            "rendering/visual/software/raster_threads.py",
        },
    ),
    "the GL context": (
        re.compile(r"^moderngl\.(create_context|create_standalone_context|get_context)$"),
        {"rendering/visual/surfaces/contexts.py", "rendering/visual/surfaces/window.py"},
    ),
}


@pytest.mark.parametrize("path", [path for path in texts() if path.endswith("/__init__.py")])
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
    assert names == {"__all__"}


def test_the_package_itself_imports_what_it_offers_when_it_is_used() -> None:
    tree = modules()["__init__.py"]
    assert {type(node) for node in tree.body} == {ast.Expr, ast.Assign, ast.FunctionDef}
    assert [node.name for node in tree.body if isinstance(node, ast.FunctionDef)] == ["__getattr__"]


def test_every_folder_with_modules_is_a_package() -> None:
    folders = {file.parent for place in (PACKAGE, BUILDERS) for file in place.rglob("*.py")}
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
    by_name = {"import_module", "__import__", "exec"}
    found = [
        f"{path}:{node.lineno}"
        for path, tree in modules().items()
        if path not in IMPORTERS_BY_NAME
        for node in nodes(tree)
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in by_name
    ]
    assert not found


def _markup_by_hand(tree: ast.Module) -> list[int]:
    """Lines of texts that hold an element of HTML or SVG."""
    tag = re.compile(r"<(?:svg|path|circle|rect|figure|html|div|table|tr|td|span|p)[ >]")
    texts = (node for node in nodes(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str))
    return [node.lineno for node in texts if tag.search(str(node.value))]


def test_markup_is_made_by_the_plotter_and_by_templates() -> None:
    """Everything else would have to remember to escape."""
    assert not [f"{path}:{line}" for path, tree in modules().items() for line in _markup_by_hand(tree)]
    by_hand = {"html.escape", "markupsafe.escape", "xml.sax.saxutils.escape"}
    found = [path for path, tree in modules().items() if by_hand & {name for _, name in imports(tree)}]
    assert found == ["plotting/marks.py"]
    assert _markup_by_hand(ast.parse("f'<td>{name}</td>'"))


@pytest.mark.parametrize(
    "path", [path for path in repository_files() if path.suffix == ".j2"], ids=lambda path: path.stem
)
def test_no_template_switches_escaping_off(path: Path) -> None:
    assert not re.search(r"\|\s*safe\b|autoescape", path.read_text(encoding="utf-8"))


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
def _classes() -> dict[str, list[ast.ClassDef]]:
    """Classes by name; a few names are those of two classes in rooms that do not meet."""
    found: dict[str, list[ast.ClassDef]] = {}
    for tree in modules().values():
        for node in nodes(tree):
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(node)
    return found


def _inherits_docstring(owner: ast.ClassDef, method: str) -> bool:
    """Whether a base class of ours, at any height, documents this method."""
    names = (ast.unparse(base).split("[")[0].rsplit(".", 1)[-1] for base in owner.bases)
    for above in (each for name in names for each in _classes().get(name, ()) if each is not owner):
        if any(getattr(node, "name", "") == method and ast.get_docstring(node) for node in above.body):  # type: ignore[arg-type]
            return True
        if _inherits_docstring(above, method):
            return True
    return False


def _is_reported_elsewhere(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> bool:
    """A setter has its getter's docstring, an @overload that of the function itself."""
    marks = [ast.unparse(mark).rsplit(".", 1)[-1] for mark in node.decorator_list]
    return "setter" in marks or "overload" in marks


def _undocumented(body: list[ast.stmt], owner: ast.ClassDef | None = None) -> Iterator[str]:
    for node in body:
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)) or node.name.startswith("_"):
            continue
        if _is_reported_elsewhere(node):
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
        if path == "__init__.py":
            continue  # asked itself, below
        defined = {getattr(node, "name", "") for node in nodes(tree)}
        defined |= {node.id for node in nodes(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        defined |= {name.rsplit(".", 1)[1] for _, name in imports(tree) if "." in name}
        offered = _offered(tree)
        if offered is None:
            faults.append(f"{path}: no __all__")
        else:
            faults += [f"{path}: {name} does not exist" for name in offered if name not in defined]
    assert not faults


def test_the_package_has_every_name_that_it_offers() -> None:
    assert all(getattr(mimics_app, name) is not None for name in mimics_app.__all__)
    assert not hasattr(mimics_app, "close")


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


def test_figures_name_what_they_depend_on_and_no_product_or_kernel() -> None:
    """A processor's name or a kernel's release says where a figure was made, and nothing that a reader can have too."""
    machine = re.compile(r"\d+ cores, \w+, python [\d.]+, numba [\d.]+(?:, Mesa [\d.]+)?")
    charts = sorted((ROOT / "docs" / "charts").glob("*.json"))
    assert charts
    for file in charts:
        assert machine.fullmatch(json.loads(file.read_text(encoding="utf-8"))["machine"]), file
    product = re.compile(r"\b(?:Xe" + r"on|EP" + r"YC|Ryz" + r"en|Thread" + r"ripper)\b|\bLinux [2-9]\.\d+")
    found = [
        str(file.relative_to(ROOT))
        for file in repository_files()
        if product.search(file.read_text(encoding="utf-8", errors="replace"))
    ]
    assert not found


PINS = ("requirements.txt", "requirements-test.txt")


def _pins(*files: str) -> list[str]:
    """The requirement lines of files of pins with their hashes, one string each."""
    text = "\n".join((ROOT / file).read_text(encoding="utf-8") for file in files)
    lines = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    return [" ".join(pin.split()) for pin in lines.replace("\\\n", " ").splitlines() if pin.strip()]


@pytest.mark.parametrize("file", PINS)
def test_requirements_name_no_place(file: str) -> None:
    """Any registry will do: what is installed is decided by the hashes."""
    text = (ROOT / file).read_text(encoding="utf-8")
    assert "://" not in text
    assert not re.search(r"^\s*-|--(?:index|extra|find|trusted)", re.sub(r"--hash=", "", text), re.MULTILINE)
    assert not re.search(r"\b[\w-]+\.(?:org|com|net|io|dev)\b", text)
    assert not re.search(r"\s@\s", text)


def test_every_requirement_is_exact_and_hashed() -> None:
    for pin in _pins(*PINS):
        assert re.match(r"^[a-z0-9._-]+==[\w.]+(?: ; .+?)?(?: --hash=sha256:[0-9a-f]{64})+$", pin), pin


def _names(*wants: list[str]) -> set[str]:
    return {re.split(r"[<>=!~ ;\[]", want)[0].lower().replace("_", "-") for group in wants for want in group}


def test_requirements_hold_what_pyproject_asks_for() -> None:
    """What running needs stands in one file, what only tests need in the other; no package stands in both."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    groups = project["dependency-groups"]
    runs, tests = ({pin.split("==")[0] for pin in _pins(file)} for file in PINS)
    assert _names(project["project"]["dependencies"], groups["build"]) <= runs
    assert _names(groups["test"]) <= tests
    assert not runs & tests
    assert not list(ROOT.glob("uv.lock")), "a lock file names a host for every file: the requirements are the lock"


def test_files_that_begin_first_are_there() -> None:
    assert set(LONGEST) <= {file.stem for file in (ROOT / "tests").rglob("test_*.py")}
