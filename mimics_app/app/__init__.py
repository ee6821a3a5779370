"""The application: command line, session, frame. The only layer that knows all others."""

__all__: list[str] = []
