"""Optimal control with CasADi: the 3-PRS robot's platform tilts and rises in half a second, with the least effort."""

import casadi as ca
import numpy as np

import nullbody

equations = nullbody.derive(nullbody.catalog.three_prs(), independent=("s1", "s2", "s3"))
model = nullbody.build(equations)
start = nullbody.assemble(model, {"s1": 0.5, "s2": 0.5, "s3": 0.5})
goal = nullbody.assemble(model, {"s1": 0.45, "s2": 0.5, "s3": 0.55}, guess=start)

# One Runge-Kutta step of x = (q, v), from the exact forward dynamics as a CasADi function.
nq, nv, steps, h = len(model.coordinates), len(model.independent), 20, 0.025
dynamics = equations.to_casadi()["forward_dynamics"]
x, u = ca.MX.sym("x", nq + nv), ca.MX.sym("u", nv)


def rate(x):
    found = dynamics(q=x[:nq], v=x[nq:], u=u, p=list(model.values))
    return ca.vertcat(found["q_dot"], found["q_ddot"][model.independent_columns])


k1 = rate(x)
k2 = rate(x + h / 2 * k1)
k3 = rate(x + h / 2 * k2)
k4 = rate(x + h * k3)
step = ca.Function("step", [x, u], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])

# Direct multiple shooting: all states and inputs are unknowns, the steps are constraints; rest at both ends.
problem = ca.Opti()
X, U = problem.variable(nq + nv, steps + 1), problem.variable(nv, steps)
problem.minimize(h * ca.sumsqr(U))
problem.subject_to(ca.vec(X[:, 1:] - step.map(steps)(X[:, :-1], U)) == 0)
problem.subject_to(X[:, 0] == ca.DM([*start.q, *np.zeros(nv)]))
problem.subject_to(X[model.independent_columns, -1] == ca.DM(goal.q[model.independent_columns]))
problem.subject_to(X[nq:, -1] == 0)
problem.set_initial(X, np.linspace([*start.q, 0, 0, 0], [*goal.q, 0, 0, 0], steps + 1).T)
problem.set_initial(U, np.tile(model.inverse_dynamics(start, [0, 0, 0]), (steps, 1)).T)
problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
solution = problem.solve()
inputs, effort = solution.value(U).T, float(solution.value(problem.f))
print(f"{solution.stats()['iter_count']} iterations, effort {effort:.4f} N^2 s, at most {abs(inputs).max():.2f} N")

# A second road, without CasADi: the same steps with the model's own exact derivatives, dx+ = A dx + B du. What the
# inputs do to the end is then a matrix E; at an optimum the slope of the effort, 2 h u, is a combination of its rows.
here, E = start, np.zeros((nq + nv, 0))
for held in inputs:
    found = model.derivatives.step(here, held, h, parameters=False)
    here, E = model.trusted_state(found.q, found.v), np.hstack([found.A @ E, found.B])
missed = np.abs(np.concatenate([here.q - goal.q, here.v])).max()
E = E[[*model.independent_columns, *range(nq, nq + nv)]]
slope = 2 * h * inputs.ravel()
left = slope - E.T @ np.linalg.lstsq(E.T, slope, rcond=None)[0]
print(f"misses the goal by {missed:.1e}; slope along the motions that keep it {np.abs(left).max() / slope.max():.1e}")

assert missed < 1e-5 and np.abs(left).max() < 1e-6 * slope.max()
