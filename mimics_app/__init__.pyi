from mimics_app.app.api.opened import open_scene as open
from mimics_app.app.api.recording import load as load
from mimics_app.contracts import errors as errors

__all__ = ["__version__", "errors", "load", "open"]

__version__: str
