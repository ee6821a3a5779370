"""Soccer in a street: turf with lines, boards, goals with nets, stands with people, a ball."""

__all__: list[str] = []
