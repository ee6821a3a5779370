"""Groups of rival methods with cost and error: a module each, named like its group, which it registers on import."""

__all__: list[str] = []
