"""Template engine for pages, with automatic escaping."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.compiled.private_folder import private_folder

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["load_templates"]


def load_templates(folder: Path, **filters: Callable[[Any], str]) -> Environment:
    """Return the template engine for a folder, with filters by name; Jinja is imported only where a page is written.

    Compiled templates are kept between starts: compiling the report's takes longer than filling it.
    """
    from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined

    kept = private_folder()
    environment = Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=None if kept is None else FileSystemBytecodeCache(str(kept), "page-%s.cache"),
    )
    environment.filters.update(filters)
    return environment
