"""Control of a gait orthosis with a hip and a knee drive per leg (D2.1 4.3): laws, limits by gait state, sequence."""

__all__: list[str] = []
