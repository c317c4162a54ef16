"""Layer 6: positions, branches, velocities, accelerations and singularities."""

from nullbody.kinematics.assemble import assemble
from nullbody.kinematics.branch import Branches, branches, inverse_kinematics
from nullbody.kinematics.newton import project
from nullbody.kinematics.singularity import Singularity, singularity
from nullbody.kinematics.sweep import sweep
from nullbody.kinematics.transport import accelerations, velocities, with_rates

__all__ = [
    "Branches",
    "Singularity",
    "accelerations",
    "assemble",
    "branches",
    "inverse_kinematics",
    "project",
    "singularity",
    "sweep",
    "velocities",
    "with_rates",
]
