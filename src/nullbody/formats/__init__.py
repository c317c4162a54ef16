"""Layer 4: mechanisms in files: YAML model files, and the formats of other tools."""

from nullbody.formats.mjcf import write_mjcf
from nullbody.formats.mjcf_reader import read_mjcf
from nullbody.formats.model_file import read_model
from nullbody.formats.rigid import RigidFrame, Step, frame, loop_points, mass_properties, number, steps, triple
from nullbody.formats.urdf_reader import read_urdf
from nullbody.formats.yaml_reader import read_yaml
from nullbody.formats.yaml_writer import write_yaml

__all__ = [
    "RigidFrame",
    "Step",
    "frame",
    "loop_points",
    "mass_properties",
    "number",
    "read_mjcf",
    "read_model",
    "read_urdf",
    "read_yaml",
    "steps",
    "triple",
    "write_mjcf",
    "write_yaml",
]
