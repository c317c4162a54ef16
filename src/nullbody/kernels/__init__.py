"""Layer 2: tapes as native code (LLVM), cached on disk, and the NumPy reference that they are compared with."""

from nullbody.kernels.attempt import Attempt
from nullbody.kernels.attempt_ir import Guard, Tableau
from nullbody.kernels.block import BlockKernel
from nullbody.kernels.bound import BoundKernel
from nullbody.kernels.cache import load, store
from nullbody.kernels.closing import Bounds, Closing, Part
from nullbody.kernels.compile import Library, compile_blocks, compile_programs
from nullbody.kernels.compose import Composer
from nullbody.kernels.evaluation import Evaluation
from nullbody.kernels.kernel import Kernel
from nullbody.kernels.march import Lanes, March
from nullbody.kernels.number import BLOCK
from nullbody.kernels.program import Program
from nullbody.kernels.reference import interpret
from nullbody.kernels.steps import Steps

__all__ = [
    "BLOCK",
    "Attempt",
    "BlockKernel",
    "BoundKernel",
    "Bounds",
    "Closing",
    "Composer",
    "Evaluation",
    "Guard",
    "Kernel",
    "Lanes",
    "Library",
    "March",
    "Part",
    "Program",
    "Steps",
    "Tableau",
    "compile_blocks",
    "compile_programs",
    "interpret",
    "load",
    "store",
]
