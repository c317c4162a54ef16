"""Layer 10: a model as a functional mock-up unit (FMI 2.0 and 3.0), model exchange and co-simulation in one file."""

from nullbody.export.fmu.write import WrittenFmu, write_fmu

__all__ = ["WrittenFmu", "write_fmu"]
