"""Input and output of commands: arguments, one JSON object for programs, lines and progress for people."""

__all__: list[str] = []
