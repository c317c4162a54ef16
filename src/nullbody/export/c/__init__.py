"""A model as a folder of C99 for a controller."""

from nullbody.export.c.folder import CFolder, write_c
from nullbody.export.c.size import ObjectSize, cortex_m7_size

__all__ = ["CFolder", "ObjectSize", "cortex_m7_size", "write_c"]
