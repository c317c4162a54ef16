"""Layer 2: tapes as native code (LLVM), cached on disk, and the NumPy reference that they are compared with."""

from nullbody.kernels.block import BlockKernel
from nullbody.kernels.compile import Library, compile_programs
from nullbody.kernels.kernel import Kernel
from nullbody.kernels.number import BLOCK
from nullbody.kernels.program import Program
from nullbody.kernels.reference import interpret

__all__ = ["BLOCK", "BlockKernel", "Kernel", "Library", "Program", "compile_programs", "interpret"]
