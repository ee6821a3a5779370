"""The experiment of the avatar at the other end of a cord (D2.1 3.4.1), as a scene file declares it: nothing is coded.

Trials name their condition by its label; the blocks of the task order them.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, field

from mimics_app.world.components.bounds import Share
from mimics_app.world.components.registry import Component

__all__ = [
    "AvatarCordSpec",
    "ConditionSpec",
    "ExperimentGoal",
    "ItemSpec",
    "ProbeSpec",
    "QuestionnaireSpec",
    "SubjectModel",
    "TapMode",
    "TapsSpec",
    "ThreatSpec",
]

TapMode = Literal["synchronous", "delayed", "jittered", "shuffled", "other_place", "none"]
_Place = Literal["cord", "back", "stomach"]
_Milliseconds = Annotated[float, Meta(ge=-2000.0, le=2000.0)]
_Seconds = Annotated[float, Meta(ge=0.0, le=3600.0)]
_Label = Annotated[str, Meta(min_length=1, max_length=64)]


class TapsSpec(Component, frozen=True):
    """Places and intervals of the taps; the intervals are irregular, drawn from the session's seed."""

    least_s: Annotated[float, Meta(ge=0.2, le=10.0, description="Shortest time between two [s]")] = 0.5
    most_s: Annotated[float, Meta(ge=0.2, le=60.0, description="Longest [s]")] = 2.0
    places: Annotated[
        list[_Place],
        Meta(
            min_length=1,
            max_length=3,
            description="Where the ball taps, in turn; on the cord from one end to the other",
        ),
    ] = field(default_factory=lambda: ["cord"])
    felt: Annotated[
        Annotated[str, Meta(pattern=r"^[a-z_0-9]{1,32}$")],
        Meta(description="Where on the subject's body taps on the cord are felt: a vibrator's name"),
    ] = "stomach"
    strength: Annotated[Share, Meta(description="Of what is felt")] = 1.0
    lasts_s: Annotated[float, Meta(ge=0.005, le=1.0, description="Of what is felt [s]")] = 0.06


class ThreatSpec(Component, frozen=True):
    """Something that happens to the avatar in front, for measuring how the subject reacts."""

    at_s: Annotated[_Seconds, Meta(description="After the taps begin [s]")]
    window_s: Annotated[float, Meta(gt=0.0, le=60.0, description="In which the reaction is looked for [s]")] = 6.0


class ConditionSpec(Component, frozen=True):
    """A condition. Omitted fields are as in everyday life: no delay, a cord of the scene's own size."""

    mode: Annotated[
        TapMode,
        Meta(
            description="synchronous; delayed: by visuo_tactile_ms; jittered: by up to that either way; shuffled: the "
            "same intervals in another order; other_place: felt elsewhere; none: no taps"
        ),
    ] = "synchronous"
    visuo_tactile_ms: Annotated[_Milliseconds, Meta(description="Felt minus seen [ms]; negative: felt first")] = 0.0
    visuo_motor_ms: Annotated[
        float, Meta(ge=0.0, le=2000.0, description="How late the avatar follows the body [ms]")
    ] = 0.0
    cord: Annotated[bool, Meta(description="False: there is none")] = True
    length_factor: Annotated[float, Meta(ge=0.25, le=8.0, description="Of its slack over the scene's own")] = 1.0
    radius_factor: Annotated[float, Meta(ge=0.25, le=8.0, description="Over the scene's own")] = 1.0
    distance_m: Annotated[float, Meta(ge=0.4, le=20.0, description="Of the avatar before the subject [m]")] = 1.2
    viewpoint: Annotated[
        Literal["first", "third"], Meta(description="From the subject's own eyes, or from behind it")
    ] = "first"
    own_body: Annotated[bool, Meta(description="False leaves the subject's body out, as before a large screen")] = True
    mimicry: Annotated[
        Literal["same", "mirror", "none"], Meta(description="What the avatar does of the subject's movements")
    ] = "same"
    places: Annotated[
        Annotated[list[_Place], Meta(min_length=1, max_length=3)] | None,
        Meta(description="Where the ball taps; absent: as `taps` says"),
    ] = None
    baseline_s: Annotated[_Seconds, Meta(description="Without taps, before them [s]")] = 5.0
    duration_s: Annotated[_Seconds, Meta(description="Of the taps [s]; ownership takes some 50 s")] = 60.0
    threat: Annotated[ThreatSpec | None, Meta(description="Absent: none")] = None


class ItemSpec(Component, frozen=True):
    """One statement to be rated."""

    id: Annotated[str, Meta(pattern=r"^[A-Za-z0-9_]{1,32}$", description="Column of the answer")]
    text: Annotated[str, Meta(min_length=1, max_length=400, description="What is read")]
    scale: Annotated[
        Literal["ownership", "agency", "control", "touch", "location", "other"], Meta(description="What it measures")
    ] = "other"


class QuestionnaireSpec(Component, frozen=True):
    """Statements rated after every trial, in the picture: left and right choose, enter answers."""

    items: Annotated[list[ItemSpec], Meta(min_length=1, max_length=100, description="The statements")]
    least: Annotated[int, Meta(ge=-10, le=10, description="Not at all")] = -3
    most: Annotated[int, Meta(ge=-10, le=10, description="Completely")] = 3
    order: Annotated[Literal["listed", "shuffled"], Meta(description="shuffled: in a new order for every trial")] = (
        "shuffled"
    )
    source: Annotated[str, Meta(max_length=400, description="Where the statements come from")] = ""


class ProbeSpec(Component, frozen=True):
    """Localisation probe: the subject moves a mark to where they feel they are, from themselves (0 m) to the avatar."""

    step_m: Annotated[float, Meta(ge=0.01, le=1.0, description="Of one press [m]")] = 0.05
    starts: Annotated[Literal["self", "avatar", "random"], Meta(description="Where the mark is at first")] = "random"


class SubjectModel(Component, frozen=True):
    """Simulated subject, whose ownership falls with the offset between seen and felt taps, and with distance."""

    window_ms: Annotated[float, Meta(gt=0.0, le=2000.0, description="Offset at which ownership is down to 1/e")] = 300.0
    motor_window_ms: Annotated[float, Meta(gt=0.0, le=2000.0, description="The same of movements")] = 250.0
    cord_gain: Annotated[Share, Meta(description="What the cord adds")] = 0.15
    spread: Annotated[float, Meta(ge=0.0, le=2.0, description="Of single answers, over the scale's half")] = 0.25
    reaction_s: Annotated[float, Meta(ge=0.1, le=30.0, description="Time for an answer [s]")] = 0.8


class AvatarCordSpec(Component, frozen=True):
    """An experiment on the bodily connection to an avatar."""

    conditions: Annotated[dict[_Label, ConditionSpec], Meta(min_length=1, max_length=200, description="By their label")]
    taps: Annotated[TapsSpec, Meta(description="When and where")] = field(default_factory=TapsSpec)
    questionnaire: Annotated[
        QuestionnaireSpec | str | None,
        Meta(description="After each trial, here or in a JSON file whose name stands here; absent: none"),
    ] = None
    probe: Annotated[ProbeSpec | None, Meta(description="Before the statements; absent: none")] = None
    simulated: Annotated[SubjectModel, Meta(description="Simulated subject that answers in a simulated session")] = (
        field(default_factory=SubjectModel)
    )

    @property
    def asked(self) -> QuestionnaireSpec | None:
        """The questionnaire, None where there is none.

        Raises:
            TypeError: its file has not been read.
        """
        if isinstance(self.questionnaire, str):
            raise TypeError(
                f'questionnaire "{self.questionnaire}" has not been read; see tasks.trial_file.resolve_files'
            )
        return self.questionnaire


class ExperimentGoal(Component, frozen=True, tag="experiment", tag_field="kind"):
    """The trial's taps, probe and questions are over."""

    hold_s: Annotated[float, Meta(ge=0.0, le=60.0, description="How long ago, at least [s]")] = 0.0
