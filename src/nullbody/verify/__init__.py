"""Layer 8: a model against independent engines that share nothing with its derivation."""

from nullbody.verify.compare import compare
from nullbody.verify.engine import AbstractEngine
from nullbody.verify.full_coordinates import MultiplierEngine
from nullbody.verify.mujoco_engine import MujocoEngine
from nullbody.verify.pinocchio_engine import PinocchioEngine
from nullbody.verify.sample import admissible_states
from nullbody.verify.verification import Discrepancy, EngineResult, Verification

__all__ = [
    "AbstractEngine",
    "Discrepancy",
    "EngineResult",
    "MujocoEngine",
    "MultiplierEngine",
    "PinocchioEngine",
    "Verification",
    "admissible_states",
    "compare",
]
