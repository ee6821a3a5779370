"""A person who walks: legs, footfalls, place and heading, shared by the kinds of task that are walks."""

__all__: list[str] = []
