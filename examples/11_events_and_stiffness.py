"""A stiff mechanism: the governor by Radau and by DOP853; an event ends a run, the next one goes on from there."""

import nullbody

published = nullbody.catalog.starts("flyball_governor")["turning"]  # IFToMM benchmark A05: k = 8e5 N/m, c = 4e4 N s/m
model = nullbody.build(nullbody.derive(published.mechanism))
start = nullbody.consistent(model, published.q, published.q_dot).state

# The springs' own motion decays within 0.1 ms or so and is soon over, but keeps the steps of an explicit method short.
for method in ("stiff", "explicit"):
    for rtol in (1e-4, 1e-6):
        second = nullbody.simulate(model, start, 1.0, method=method, rtol=rtol)
        kept = second.statistics
        print(f"{method:8} rtol {rtol:g}: s(1) = {second['s'][-1]:.8f} m, {kept.steps} steps, {kept.evaluations} calls")

# An event is looked for where a function of time and state passes through zero: here the slider on its way up. A
# terminal one ends the run; `state` is where the next begins, at its time.
high = nullbody.Event("high", lambda t, x: x["s"] - 0.7, direction=+1, terminal=True)
rise = nullbody.simulate(model, start, 10.0, method="stiff", rtol=1e-8, events=[high])
print(f"{rise.outcome.name}: {rise.events[0].name!r} at t = {rise.t[-1]:.6f} s, s = {rise['s'][-1]:.12f} m")

here = rise.state(rise.t[-1])
free = nullbody.simulate(model, here, 10.0, method="stiff", rtol=1e-8)
braked = nullbody.simulate(model, here, 10.0, method="stiff", rtol=1e-6, u={"torque": -0.5})
print(f"free it goes on to s = {free['s'][-1]:.10f} m at t = {free.t[-1]:g} s")
print(f"with a brake on the shaft to s = {braked['s'][-1]:.4f} m, turning by {braked.v[-1, 0]:.3f} rad/s")

# The published motion, recomputed in quadruple precision, ends at this height; nothing was lost by the restart.
assert abs(free["s"][-1] - 0.6196229170613656) < 1e-8
assert rise.outcome.name == "EVENT" and abs(rise["s"][-1] - 0.7) < 1e-12
