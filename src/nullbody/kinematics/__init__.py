"""Layer 6: positions, branches, velocities, accelerations and singularities."""

from nullbody.kinematics.assemble import assemble
from nullbody.kinematics.branch import Branches, branches, inverse_kinematics
from nullbody.kinematics.chart import Configuration, regular_chart, regularity
from nullbody.kinematics.consistent import ConsistentState, consistent
from nullbody.kinematics.newton import project
from nullbody.kinematics.singularity import Singularity, singularity
from nullbody.kinematics.sweep import sweep
from nullbody.kinematics.transport import accelerations, velocities, with_rates

__all__ = [
    "Branches",
    "Configuration",
    "ConsistentState",
    "Singularity",
    "accelerations",
    "assemble",
    "branches",
    "consistent",
    "inverse_kinematics",
    "project",
    "regular_chart",
    "regularity",
    "singularity",
    "sweep",
    "velocities",
    "with_rates",
]
