"""A session: the objects one run owns, and their construction."""

__all__: list[str] = []
