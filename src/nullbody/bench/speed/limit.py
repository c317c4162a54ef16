"""What the machine can do at most, measured: fused multiply-adds per second of one core, and bytes copied per second.

A kernel of `operations` that moves `bytes` per state takes at least max(operations / peak, bytes / bandwidth).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.bench.speed.interleave import interleaved
from nullbody.bench.timing import Work

__all__ = ["Limit", "machine_limit"]

_CHAINS = 16  # independent sums: more than latency times units of any processor
_COPY = 2**26  # bytes of a copy: more than the caches hold


@dataclass(frozen=True)
class Limit:
    """The machine's limits, one core.

    Attributes:
        lanes: numbers in a vector register.
        scalar: operations per second on single numbers; a fused multiply-add is two [1/s].
        vector: the same on whole registers [1/s].
        bandwidth: bytes read and written per second by a copy between large arrays [1/s].
    """

    lanes: int
    scalar: float
    vector: float
    bandwidth: float

    def seconds(self, operations: int, size: int = 0, wide: bool = True) -> float:
        """Least time of some operations on some bytes [s].

        Args:
            operations: arithmetic ones.
            size: bytes that go to and from memory; 0 where all stays in the caches.
            wide: whether they can be done on whole registers.
        """
        return max(operations / (self.vector if wide else self.scalar), size / self.bandwidth)


def machine_limit(repeats: int = 50, seconds: float = 2e-3) -> Limit:
    """Measure this machine: the best of some turns, for other work only ever slows it."""
    source, target = np.ones(_COPY // 8), np.zeros(_COPY // 8)
    lanes, engine = _engine()

    def copy(rounds: int) -> None:
        for _ in range(rounds):
            np.copyto(target, source)

    works = {
        "scalar": Work(_loop(engine, "one"), 2 * _CHAINS),
        "vector": Work(_loop(engine, "all"), 2 * _CHAINS * lanes),
        "copy": Work(copy, 2 * _COPY),
    }
    turns = interleaved(works, repeats, seconds)
    return Limit(lanes, *(1 / min(turns.seconds[name]) for name in works))


def _loop(engine: Any, name: str) -> Callable[[int], None]:
    function = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_void_p)(engine.get_function_address(name))
    target = np.zeros(8 * _CHAINS * 8)

    def run(rounds: int, owner: Any = engine) -> None:
        function(rounds, target.ctypes.data)

    return run


def _engine() -> tuple[int, Any]:
    """Numbers in a register, and loops of independent x <- x a + b on single numbers and on whole registers."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    known = features.split(",")
    lanes = 8 if "+avx512f" in known else 4 if "+avx" in known else 2
    target = llvm.Target.from_default_triple()
    machine = target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=2)
    text = _function("one", "double", "f64", 1) + _function("all", f"<{lanes} x double>", f"v{lanes}f64", lanes)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(text), machine)
    engine.finalize_object()
    return lanes, engine


def _function(name: str, kind: str, suffix: str, lanes: int) -> str:
    """void name(i64 rounds, ptr sums): every sum once a round."""

    def value(number: float) -> str:
        one = f"double {number!r}"
        return f"{number!r}" if lanes == 1 else f"<{', '.join([one] * lanes)}>"

    sums = "\n".join(f"  %x{k} = phi {kind} [{value(1.0 + k)}, %start], [%y{k}, %loop]" for k in range(_CHAINS))
    steps = "\n".join(
        f"  %y{k} = call {kind} @llvm.fma.{suffix}({kind} %x{k}, {kind} {value(0.999)}, {kind} {value(0.001)})"
        for k in range(_CHAINS)
    )
    stores = "\n".join(
        f"  %p{k} = getelementptr {kind}, ptr %sums, i64 {k}\n  store {kind} %y{k}, ptr %p{k}, align 8"
        for k in range(_CHAINS)
    )
    return f"""
declare {kind} @llvm.fma.{suffix}({kind}, {kind}, {kind})
define void @{name}(i64 %rounds, ptr %sums) {{
start:
  br label %loop
loop:
  %i = phi i64 [0, %start], [%j, %loop]
{sums}
{steps}
  %j = add i64 %i, 1
  %more = icmp ult i64 %j, %rounds
  br i1 %more, label %loop, label %end
end:
{stores}
  ret void
}}
"""
