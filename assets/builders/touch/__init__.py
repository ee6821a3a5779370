"""The two models of scenes/examples/models.json."""

__all__: list[str] = []
