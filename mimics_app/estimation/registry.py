"""Estimators of the person's state: the built-in ones, and those of installed packages (`mimics_app.estimators`)."""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import cast

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup, fault_of_builder
from mimics_app.contracts.ports.stages import Estimation
from mimics_app.estimation import estimators

__all__ = ["BUILT_IN", "DEFAULT", "PLUGINS", "build_estimation", "check_estimator"]

PLUGINS = PluginGroup("mimics_app.estimators", fault_of_builder(Estimation))
"""Each is called with the length of the calibration [s]."""

BUILT_IN = member_names(estimators)
"""Built-in estimators. All estimate arousal, valence and effort by the Kalman fusion and differ in the load."""

DEFAULT = "adaptive_lda"
"""Default estimator: the most accurate on the load of unseen people (chart "load of the person")."""


def check_estimator(name: str) -> None:
    """Check that an estimator exists; "" is the default.

    Raises:
        UsageError: There is none of this name.
    """
    if name and name not in BUILT_IN and name not in (names := PLUGINS.names()):
        raise UsageError(f'there is no estimator "{name}"', nearest(name, [*BUILT_IN, *names]))


def build_estimation(name: str, baseline_s: float) -> Estimation:
    """Build an estimator by its name, "" for the default.

    Raises:
        UsageError: There is none of this name, or its plug-in cannot be loaded.
        SceneError: Its training data are missing from the installation.
    """
    check_estimator(name)
    return _find(name or DEFAULT)(baseline_s)


def _find(name: str) -> Callable[[float], Estimation]:
    if name in BUILT_IN:
        return cast(Callable[[float], Estimation], load_member(estimators, name, "build", FunctionType))
    try:
        return cast(Callable[[float], Estimation], PLUGINS.load(name))
    except PluginError as error:
        raise UsageError(f'the estimator "{name}" is not available: {error}') from error
