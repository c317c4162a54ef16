"""Layer 9: what is measured against other tools.

Here the null space, against the methods of the literature too; in `speed` models: derived, built, evaluated, simulated.
"""

from nullbody.bench.benchmark import bench_null_space
from nullbody.bench.result import Benchmark
from nullbody.bench.settings import PARTS, Settings

__all__ = ["PARTS", "Benchmark", "Settings", "bench_null_space"]
