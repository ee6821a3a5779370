from mimics_app.app.api.loaded_run import load as load
from mimics_app.app.api.opened import open as open
from mimics_app.contracts import errors as errors
from mimics_app.contracts.commands.vocabulary import (
    Calibrate as Calibrate,
)
from mimics_app.contracts.commands.vocabulary import (
    Confirm as Confirm,
)
from mimics_app.contracts.commands.vocabulary import (
    End as End,
)
from mimics_app.contracts.commands.vocabulary import (
    Fault as Fault,
)
from mimics_app.contracts.commands.vocabulary import (
    Mark as Mark,
)
from mimics_app.contracts.commands.vocabulary import (
    Mute as Mute,
)
from mimics_app.contracts.commands.vocabulary import (
    Note as Note,
)
from mimics_app.contracts.commands.vocabulary import (
    Obstacle as Obstacle,
)
from mimics_app.contracts.commands.vocabulary import (
    Pause as Pause,
)
from mimics_app.contracts.commands.vocabulary import (
    Policy as Policy,
)
from mimics_app.contracts.commands.vocabulary import (
    Recalibrate as Recalibrate,
)
from mimics_app.contracts.commands.vocabulary import (
    Repeat as Repeat,
)
from mimics_app.contracts.commands.vocabulary import (
    Reset as Reset,
)
from mimics_app.contracts.commands.vocabulary import (
    Resume as Resume,
)
from mimics_app.contracts.commands.vocabulary import (
    SetAssistance as SetAssistance,
)
from mimics_app.contracts.commands.vocabulary import (
    SetParameter as SetParameter,
)
from mimics_app.contracts.commands.vocabulary import (
    Skip as Skip,
)
from mimics_app.contracts.commands.vocabulary import (
    StartTrial as StartTrial,
)
from mimics_app.contracts.commands.vocabulary import (
    Stop as Stop,
)
from mimics_app.contracts.commands.vocabulary import (
    View as View,
)
from mimics_app.contracts.commands.vocabulary import (
    Volume as Volume,
)

__all__ = [
    "Calibrate",
    "Confirm",
    "End",
    "Fault",
    "Mark",
    "Mute",
    "Note",
    "Obstacle",
    "Pause",
    "Policy",
    "Recalibrate",
    "Repeat",
    "Reset",
    "Resume",
    "SetAssistance",
    "SetParameter",
    "Skip",
    "StartTrial",
    "Stop",
    "View",
    "Volume",
    "__version__",
    "errors",
    "load",
    "open",
]

__version__: str
