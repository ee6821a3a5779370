"""Built-in controllers: a module each, named like it, with `CONTROLLER`; imported and compiled on request."""

__all__: list[str] = []
