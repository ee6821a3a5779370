"""One module per scenario, paired with the scene of its name in `scenes/`."""

__all__: list[str] = []
