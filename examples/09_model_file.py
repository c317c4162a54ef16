"""A model file: written as YAML, read, run, written again; and as MJCF, run by MuJoCo where that is installed."""

import tempfile
from importlib.util import find_spec
from pathlib import Path

import nullbody
from nullbody.formats import write_mjcf, write_yaml

TEXT = """
nullbody: 1
name: pump
gravity: [0, 0, -9.81]                  # SI units everywhere
parameters:
  r: {default: 0.05, unit: m, meaning: crank}
  l: {default: 4*r, unit: m, meaning: rod}
bodies:
  crank: {type: rod, mass: 0.5, length: r}
  rod: {type: rod, mass: 0.8, length: l, radius: 0.01}
  piston: {type: cylinder, mass: 1.2, radius: 0.04, length: 0.05, axis: x}
joints:                                 # which of them closes the loop is found
  shaft: {type: revolute, parent: ground, child: crank, axis: y}
  pin: {type: spherical, parent: crank, child: rod, at: [r, 0, 0], loop: true}
  gudgeon: {type: revolute, parent: piston, child: rod, on: [l, 0, 0], axis: y}
  bore: {type: prismatic, parent: ground, child: piston, axis: x}
loads:
  spring: {type: coordinate_spring, coordinate: bore, stiffness: 200, rest: 5*r, damping: 2}
actuators:
  torque: {coordinate: shaft, limits: [-10, 10]}
home: {shaft: 0.3, bore: 5*r}
"""
folder = Path(tempfile.mkdtemp(prefix="nullbody-example-"))
(folder / "pump.yaml").write_text(TEXT, encoding="utf-8")
pump = nullbody.read_model(folder / "pump.yaml")
model = nullbody.build(nullbody.derive(pump))
start = nullbody.assemble(model, {"shaft": 0.3})
motion = nullbody.simulate(model, start, 0.3, u={"torque": 1.0})
print(pump, motion, f"shaft at the end: {motion['shaft'][-1]:.4f} rad", sep="\n")
again = nullbody.read_model(write_yaml(pump))

(folder / "pump.xml").write_text(write_mjcf(pump), encoding="utf-8")
print(*sorted(path.name for path in folder.iterdir()), "in", folder)
gap = 0.0
if find_spec("mujoco"):
    import mujoco

    print("MuJoCo's loops give way and brake the crank: the softest are as it comes, the stiffest need small steps")
    for step, constant, hold in ((1e-4, 0.02, 0.9), (1e-4, 8e-4, 0.9999), (2e-5, 4e-4, 0.9999)):
        engine = mujoco.MjModel.from_xml_path(str(folder / "pump.xml"))
        engine.opt.timestep, engine.eq_solref[:], engine.eq_solimp[:, :2] = step, (constant, 1), (hold, max(hold, 0.95))
        data = mujoco.MjData(engine)
        data.qpos[:] = [start[engine.joint(k).name] for k in range(engine.njnt)]
        data.ctrl[:] = 1.0
        mujoco.mj_step(engine, data, round(0.3 / step))
        angle = data.joint("shaft").qpos[0]
        gap = abs(angle - motion["shaft"][-1])
        print(f"  loops of {1000 * constant:4.1f} ms, steps of {1e6 * step:3.0f} us: {angle:.4f} rad, off by {gap:.4f}")
else:
    print("MuJoCo is not installed: that comparison is left out (pip install mujoco)")
assert again == pump and motion.outcome.ok and gap < 0.01
