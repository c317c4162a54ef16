"""Files for other programs: NetCDF, CSV, LaTeX, and a figure drawn without pyplot's global state."""

import tempfile
from pathlib import Path

import numpy as np
import xarray
from matplotlib.figure import Figure

import nullbody
from nullbody.control import ComputedTorque, paper_reference

robot = nullbody.catalog.three_prs()
equations = nullbody.derive(robot, independent=("s1", "s2", "s3"))
model = nullbody.build(equations)
reference = paper_reference()
start = nullbody.assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6}, v=reference(0.0).rate)
motion = nullbody.simulate(model, start, 3.0, u=ComputedTorque(model, reference), samples=301)

folder = Path(tempfile.mkdtemp(prefix="nullbody-example-"))
nullbody.export.write_netcdf(motion, folder / "run.nc")
nullbody.export.write_csv(motion, folder / "run.csv")
nullbody.export.write_latex(equations, folder / "robot.tex", names=["Phi", "M", "N_scaled"])

figure = Figure(figsize=(7, 5), layout="constrained")
upper, lower = figure.subplots(2, sharex=True)
data = motion.to_xarray()
for name in ("s1", "s2", "s3"):
    upper.plot(data.t, data[name], label=name)
for name in model.inputs:
    lower.plot(data.t, data[name], label=name)
upper.set_ylabel("sliders [m]")
lower.set(xlabel="t [s]", ylabel="forces [N]")
for axes in (upper, lower):
    axes.legend(loc="upper right")
figure.savefig(folder / "run.png")
print(*sorted(path.name for path in folder.iterdir()), "in", folder)

with xarray.open_dataset(folder / "run.nc") as again:
    table = np.genfromtxt(folder / "run.csv", delimiter=",", names=True)
    assert all(np.array_equal(again[name], data[name]) and np.array_equal(table[name], data[name]) for name in data)
