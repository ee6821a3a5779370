"""Catalogue of the groups of methods: the modules of the package `groups`, and those of installed packages.

A module is named like its group, and registers it on import: only what is measured is imported.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import cache

from mimics_app.contracts.errors import require_choice, short_text
from mimics_app.contracts.ports.members import import_member, member_names
from mimics_app.contracts.ports.methods import Registry, registry
from mimics_app.lab import groups
from mimics_app.lab.rivals import group_of
from mimics_app.world.files.scene.method_plugins import method_plugins

__all__ = ["GROUPS", "all_groups", "load_methods"]

GROUPS = {group_of(name): name for name in member_names(groups)}
"""Module of the package `groups` that registers a group, by the group's name."""


def all_groups() -> list[str]:
    """Return the names of the groups, those of installed packages last."""
    return list(dict.fromkeys([*GROUPS, *(plugin.group for plugin in method_plugins())]))


def load_methods(names: Iterable[str] | None = None) -> Registry:
    """Register the methods of some groups, or of all, and return the registry; other modules are not imported.

    Raises:
        UsageError: The group is unknown.
    """
    known = all_groups()
    for group in known if names is None else names:
        require_choice(group, known, "group of methods")
        if group in GROUPS:
            _register(group)
        _register_plugins(group)
    return registry


def _register(group: str) -> None:
    """Import the module of a built-in group.

    Raises:
        ImportError: It registers no method.
    """
    import_member(groups, GROUPS[group])
    if group not in registry.groups():
        raise ImportError(f'{groups.__name__}.{GROUPS[group]} registers no method of "{group}"')


@cache
def _register_plugins(group: str) -> None:
    """Register the methods of installed packages in a group, once; report on stderr what cannot be registered."""
    for plugin in method_plugins():
        if plugin.group != group:
            continue
        try:
            registry.take(group, plugin.register)
        except Exception as error:  # noqa: BLE001 a third-party function may raise anything
            why, where = short_text(f"{type(error).__name__}: {error}"), plugin.register.__module__
            sys.stderr.write(f'mimics: the methods of {where} for "{group}" are left out: {why}\n')
