"""Layer 9: the null space measured against the methods of the literature and against other tools."""

from nullbody.bench.benchmark import bench_null_space
from nullbody.bench.result import Benchmark
from nullbody.bench.settings import PARTS, Settings

__all__ = ["PARTS", "Benchmark", "Settings", "bench_null_space"]
