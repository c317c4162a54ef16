"""Layer 10: files for other programs. Each is there completely or not at all."""

from nullbody.export.c import CFolder, ObjectSize, cortex_m7_size, write_c
from nullbody.export.csv import write_csv
from nullbody.export.fmu import WrittenFmu, write_fmu
from nullbody.export.latex import write_latex
from nullbody.export.netcdf import write_netcdf
from nullbody.export.target import check_target

__all__ = [
    "CFolder",
    "ObjectSize",
    "WrittenFmu",
    "check_target",
    "cortex_m7_size",
    "write_c",
    "write_csv",
    "write_fmu",
    "write_latex",
    "write_netcdf",
]
