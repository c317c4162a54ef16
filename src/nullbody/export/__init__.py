"""Layer 9: files for other programs. Each is there completely or not at all."""

from nullbody.export.csv import write_csv
from nullbody.export.latex import write_latex
from nullbody.export.netcdf import write_netcdf
from nullbody.export.target import check_target

__all__ = ["check_target", "write_csv", "write_latex", "write_netcdf"]
