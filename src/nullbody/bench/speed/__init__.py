"""How fast models are derived, built, evaluated and simulated, beside other tools on the same work in the same run."""

from nullbody.bench.speed.effort import SUBJECTS, Effort
from nullbody.bench.speed.result import Curve, Goal, Growth, Line, Point, Speed
from nullbody.bench.speed.run import bench_speed, steps

__all__ = ["SUBJECTS", "Curve", "Effort", "Goal", "Growth", "Line", "Point", "Speed", "bench_speed", "steps"]
