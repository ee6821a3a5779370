"""The operator's page: two processes beside the session, one for STOP and one for everything else."""

__all__: list[str] = []
