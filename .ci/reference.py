"""Reference pages of the website, from the sources: commands, components of a scene, columns of a recording, Python.

python .ci/reference.py FOLDER
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout, suppress
from io import StringIO
from pathlib import Path
from typing import Any

import mimics_app
import mimics_app.app.scenes.loading  # registers the types of every stage
from mimics_app.app.api.loaded_run import Recording
from mimics_app.app.api.opened import Opened
from mimics_app.app.cli import COMMANDS, parse
from mimics_app.contracts import errors
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS
from mimics_app.world.files.scene.schema import scene_schema

__all__ = ["PAGES"]

WIDTH = "110"
"""Width of the help of a command [characters]."""


def commands() -> Iterator[str]:
    """The help of every command."""
    yield "# Commands\n\nWhat `mimics COMMAND --help` prints.\n"
    for command in COMMANDS:
        printed = StringIO()
        with redirect_stdout(printed), suppress(SystemExit):
            parse([command, "--help"])
        yield f"## {command}\n\n```text\n{printed.getvalue().strip()}\n```\n"


def components() -> Iterator[str]:
    """The fields of every component, of the task and of the systems."""
    known = scene_schema()["$defs"]
    yield "# Components of a scene\n\nFrom `mimics schema`. Examples: [table of blocks](../docs/blocks.md).\n"
    named = known["EntitySpec"]["properties"]["components"]["properties"]
    for name, places in sorted(named.items()):
        kind = places["anyOf"][0]["$ref"].rpartition("/")[2].removesuffix("Partial")
        yield f"## {name}\n\n{known[kind].get('description', '')}\n\n{_fields(known[kind])}"
    for title, kind in (("The task", "TaskSpec"), ("An entity", "EntitySpec")):
        yield f"## {title}\n\n{known[kind].get('description', '')}\n\n{_fields(known[kind])}"


def _fields(kind: dict[str, Any]) -> str:
    rows = ["| field | value | default | meaning |", "|---|---|---|---|"]
    for name, field in kind.get("properties", {}).items():
        default = f"`{field['default']!r:.60}`" if field.get("default") is not None else ""
        rows.append(f"| `{name}` | {_value(field)} | {_cell(default)} | {_cell(field.get('description', ''))} |")
    return "\n".join(rows) + "\n" if len(rows) > 2 else "No fields.\n"


def _value(field: dict[str, Any]) -> str:
    if "$ref" in field:
        return str(field["$ref"]).rpartition("/")[2].removesuffix("Partial")
    if "anyOf" in field:
        return " or ".join(dict.fromkeys(_value(each) for each in field["anyOf"] if each.get("type") != "null"))
    if "enum" in field:
        return ", ".join(f"`{each}`" for each in field["enum"])
    low, high = field.get("minimum", field.get("exclusiveMinimum")), field.get("maximum", field.get("exclusiveMaximum"))
    bounds = f" {low:g} to {high:g}" if low is not None and high is not None else ""
    return f"{field.get('type', 'any')}{bounds}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def columns() -> Iterator[str]:
    """The fields of a tick."""
    meaning = "[recordings](../docs/recording.md#what-the-numbers-mean)"
    yield f"# Columns of a recording\n\nOne row a millisecond; what they mean: {meaning}.\n"
    yield "| column | unit | numbers | of each | replay |\n|---|---|---|---|---|"
    for field in LOOP_FIELDS:
        if field.replay.name != "ABSENT":
            per = field.per.name.lower()
            yield f"| `{field.name}` | {field.unit} | {field.size} | {per} | {field.replay.value} |"


def python() -> Iterator[str]:
    """What `import mimics_app` offers, and the objects that it returns."""
    yield "# Python interface\n\nWith examples: [from Python](../docs/python.md). Shapes and units stand with each.\n"
    for name in sorted(set(mimics_app.__all__) - {"__version__", "errors"}):
        yield _object(f"mimics.{name}", getattr(mimics_app, name))
    for name, kind in (("An open scene", Opened), ("A recording", Recording)):
        yield _object(name, kind)
        yield from (_object(member, value, 3) for member, value in vars(kind).items() if member[0] != "_")
    for name in errors.__all__:
        if inspect.isclass(kind := getattr(errors, name)) and issubclass(kind, Exception):
            yield _object(f"mimics.errors.{name}", kind)


def _object(name: str, thing: Any, depth: int = 2) -> str:
    target = thing.fget if isinstance(thing, property) else thing
    signature = f"{inspect.signature(target)}".replace("'", "") if inspect.isfunction(thing) else ""
    if inspect.isclass(thing) and hasattr(thing, "__struct_fields__"):  # a command
        signature = f"({', '.join(thing.__struct_fields__)})"
    described = inspect.getdoc(target) or ""
    return f"{'#' * depth} {name}\n\n```text\n{name.rpartition('.')[2]}{signature}\n\n{described}\n```\n"


PAGES = {"commands": commands, "components": components, "columns": columns, "python": python}
"""What writes each page."""

if __name__ == "__main__":
    os.environ["COLUMNS"] = WIDTH
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for page, write in PAGES.items():
        (folder / f"{page}.md").write_text("\n".join(write()) + "\n", encoding="utf-8")
