"""Change of a scene for the person who plays it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.scenes.contrasted_scene import contrasted
from mimics_app.app.scenes.fitted_scene import fitted
from mimics_app.app.scenes.mirrored_scene import mirrored
from mimics_app.app.settings import Side
from mimics_app.contracts.errors import Issue, SceneError, UsageError
from mimics_app.contracts.messages.calibration_record import Calibration
from mimics_app.contracts.messages.fit import Fit, FitLimits, fit_of
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.world.files.scene.scene import Scene

__all__ = ["OWN_BODY", "FitFile", "PersonEdit", "edit_of_plain", "plain_edit", "read_fit"]

OWN_BODY = "own_body"
"""Asset of a scene that is the body of the person who plays."""

_LARGEST = 1 << 20
"""Largest file of a fit [bytes]."""


class FitFile(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """File of a fit, JSON.

    Attributes:
        calibration: What was measured.
        limits: How far the tasks may be fitted.
    """

    calibration: Calibration
    limits: FitLimits = FitLimits()


class PersonEdit(msgspec.Struct, frozen=True):
    """Change of the resolved document of a scene, see `world.files.scene.scene.SceneEdit`.

    Attributes:
        fit: What fits the person.
        side: Side that plays, "left" or "right"; scenes are made for the right one.
        avatar: File of a model that is the person's own body in scenes that show one; "": as the scene has it.
        contrast: Whether the scene has the colours of high contrast.
    """

    fit: Fit = Fit()
    side: Side = "right"
    avatar: str = ""
    contrast: bool = False

    def __call__(self, document: dict[str, Any]) -> dict[str, Any]:
        """Return a changed copy of a document; it is fitted on the side that plays.

        Raises:
            UsageError: The scene cannot be mirrored, or shows no own body.
        """
        if self.avatar and OWN_BODY not in document["assets"]:
            raise UsageError("this scene shows no own body", "leave --avatar out")
        shown = fitted(mirrored(document) if self.side == "left" else document, self.fit)
        return contrasted(shown) if self.contrast else shown

    def files(self) -> Mapping[str, Path]:
        """Return the model of the person's own body, by the asset that it replaces."""
        return {OWN_BODY: Path(self.avatar)} if self.avatar else {}


def plain_edit(scene: Scene) -> dict[str, object]:
    """Return the change of a scene for the person who plays as plain JSON, {} for none."""
    edit = scene.edit
    return msgspec.to_builtins(edit) if isinstance(edit, PersonEdit) else {}


def edit_of_plain(plain: Mapping[str, object]) -> PersonEdit | None:
    """Return the change of `plain_edit`, None for none.

    Raises:
        msgspec.ValidationError: It is damaged.
    """
    return msgspec.convert(plain, PersonEdit) if plain else None


def read_fit(place: Path) -> Fit:
    """Return what fits the person of a calibration.

    Args:
        place: Run folder of the calibration, or a `FitFile`.

    Raises:
        SceneError: It cannot be read, or nothing was measured there.
    """
    if place.is_dir():
        from mimics_app.recording.calibrations import calibration_of
        from mimics_app.recording.run import Run

        calibration = calibration_of(Run.open(place))
        if calibration is None:
            raise SceneError(Issue(str(place), "", "nothing was calibrated in this run", "mimics run calibration"))
        return fit_of(calibration, FitLimits())
    try:
        given = msgspec.json.decode(read_regular(place, _LARGEST), type=FitFile)
    except (OSError, ValueError, RecursionError, msgspec.MsgspecError) as error:
        what, fix = f"is no fit of a person: {error}", "see docs/guide/fitting.md"
        raise SceneError(Issue(str(place), "", what, fix)) from error
    return fit_of(given.calibration, given.limits)
