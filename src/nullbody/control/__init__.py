"""Layer 8: references with exact derivatives, feed-forward and computed torque."""

from nullbody.control.controller import ComputedTorque, FeedForward
from nullbody.control.desired import DesiredMotion, desired_motion
from nullbody.control.reference import AbstractReference, Demand, Quintic, Sine, paper_reference

__all__ = [
    "AbstractReference",
    "ComputedTorque",
    "Demand",
    "DesiredMotion",
    "FeedForward",
    "Quintic",
    "Sine",
    "desired_motion",
    "paper_reference",
]
