"""Many robots in lock step: masses and starts at random, results streamed to a file, one of them against `simulate`."""

import tempfile
from pathlib import Path

import numpy as np

import nullbody

COUNT = 20_000
robot = nullbody.catalog.three_prs()
model = nullbody.build(nullbody.derive(robot, independent=("s1", "s2", "s3")))
start = nullbody.assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6})

draw = np.random.default_rng(1)
guess = np.tile(start.q, (COUNT, 1))
guess[:, model.independent_columns] += draw.uniform(-0.05, 0.05, (COUNT, 3))
assemblies = model.batch.assemble(guess)  # Newton on all of them, the slides held
masses = {"M": draw.normal(1.0, 0.05, COUNT)}  # of the platform [kg]; its inertia follows
print(assemblies)

gains = np.array([10.0, 1.0])  # N/m, N s/m
u = model.batch.inverse_dynamics(start.q[None], np.zeros((1, 3)), np.zeros((1, 3)))[0]  # holds the nominal robot


def control(t, q, v):
    """Forces of all robots, held until the next evaluation."""
    return u - gains[0] * (q[:, model.independent_columns] - 0.6) - gains[1] * v


with tempfile.TemporaryDirectory(prefix="nullbody-example-") as folder:
    runs = nullbody.simulate_batch(
        model,
        (assemblies.q, np.zeros(3)),
        np.linspace(0, 0.5, 11),
        control,
        hold=0.01,
        step=0.005,
        parameters=masses,
        to=Path(folder) / "robots.nc",
    )
    print(runs)
    with runs.to_xarray() as data:  # opened, and read as far as it is asked for
        height = data["q"].sel(coordinate="y")
        spread = height.std("robot").values
        last = data["q"].isel(t=-1, robot=7).values
print("spread of the heights [mm]:", (1e3 * spread[::5]).round(2))

heavy = model.replace(M=masses["M"][7])
state = heavy.state(assemblies.q[7])
for k in range(50):  # the same robot alone, its inputs held for 10 ms each
    forces = control(0.0, state.q[None], state.v[None])[0]
    state = nullbody.simulate(heavy, state, 0.01 * (k + 1), u=forces, t0=0.01 * k).state(0.01 * (k + 1))
assert runs.completed.all()
assert np.abs(last - state.q).max() < 1e-6
