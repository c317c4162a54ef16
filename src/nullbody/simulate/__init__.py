"""Layer 7: motion in time, with the loops kept closed."""

from nullbody.simulate.batch import simulate_batch
from nullbody.simulate.batch_result import BatchStatistics, BatchTrajectory
from nullbody.simulate.event import Event, Happened
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.progress import progress_bar
from nullbody.simulate.simulate import simulate
from nullbody.simulate.trajectory import Sample, Statistics, Trajectory

__all__ = [
    "BatchStatistics",
    "BatchTrajectory",
    "Event",
    "Happened",
    "Outcome",
    "Sample",
    "Statistics",
    "Trajectory",
    "progress_bar",
    "simulate",
    "simulate_batch",
]
