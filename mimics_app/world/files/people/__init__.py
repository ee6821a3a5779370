"""People of given measures, made from the shipped ones."""

__all__: list[str] = []
