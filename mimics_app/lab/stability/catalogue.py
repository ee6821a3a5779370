"""Catalogue of the stability experiments: the modules `sNN_noun` here.

Each holds one `EXPERIMENT`, named by the beginning of its file (`s03r_wall_rate`: S3R), and is imported on request.
"""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from pathlib import Path

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.lab import stability
from mimics_app.lab.experiment import Experiment

__all__ = ["NAMES", "describe_experiment", "load_experiment", "load_experiments"]

_MODULES = {
    f"S{int(found[1])}{found[2].upper()}": name
    for name in member_names(stability)
    if (found := re.match(r"s(\d\d)([a-z]?)_", name))
}
"""Module of this package by the name of its experiment, in the order of their numbers."""

NAMES = tuple(_MODULES)


def describe_experiment(name: str) -> str:
    """Return title and claim of an experiment, read from its source: its import compiles the functions of the loop.

    Args:
        name: One of `NAMES`.
    """
    tree = ast.parse((Path(stability.__path__[0]) / f"{_MODULES[name]}.py").read_text(encoding="utf-8"))
    stated = (node.value for node in tree.body if isinstance(node, ast.Assign) and _is_experiment(node))
    texts = {word.arg: word.value for call in stated if isinstance(call, ast.Call) for word in call.keywords}
    return f"{ast.literal_eval(texts['title'])}: {ast.literal_eval(texts['claim'])}"


def _is_experiment(node: ast.Assign) -> bool:
    return any(isinstance(target, ast.Name) and target.id == "EXPERIMENT" for target in node.targets)


def load_experiment(name: str) -> Experiment:
    """Return the experiment of a name such as "S3", in any case.

    Raises:
        UsageError: There is none.
    """
    key = name.upper()
    if key not in _MODULES:
        raise UsageError(f'there is no experiment "{name}"', nearest(key, NAMES))
    return replace(load_member(stability, _MODULES[key], "EXPERIMENT", Experiment), name=key)


def load_experiments(names: tuple[str, ...] = ()) -> list[Experiment]:
    """Return the experiments of these names, or all."""
    return [load_experiment(name) for name in names or NAMES]
