"""Section 1: the robot, drawn and in numbers (Fig. 1, Tables 1 and 2)."""

from __future__ import annotations

from nullbody.report.case import Case
from nullbody.report.figure import drawing, svg
from nullbody.report.picture import draw_pair
from nullbody.report.section import Check, Figure, Section, Table, Text

__all__ = ["robot"]

_PAPER = {"a": 0.8, "b": 0.2, "l": 0.5, "M": 1.0, "m": 0.1, "g": 9.8}  # Table 2
_MIDDLE = 1.5  # s


def robot(case: Case) -> Section:
    """Two drawings of the robot, its DH row and its parameters."""
    model, home = case.model, case.desired.state(0.0)
    middle = case.desired.state(min(_MIDDLE, case.settings.duration))
    with drawing(9.6, 3.5) as canvas:
        draw_pair(canvas, model, [(home, "t = 0 s: all links vertical"), (middle, "t = 1.5 s of the paper's motion")])
        picture = svg(canvas)
    ours = model.parameters
    units = {p.name: p.unit for p in model.mechanism.parameters}
    meanings = {p.name: p.meaning for p in model.mechanism.parameters}
    rows = [
        (name, meanings[name], units[name].replace("^2", "²"), _shown(_PAPER.get(name)), f"{ours[name]:g}")
        for name in ours
    ]
    same = all(ours[name] == value for name, value in _PAPER.items())
    return Section(
        "robot",
        "The robot",
        (
            Text(
                "The 3-PRS robot carries a platform on three legs. Each leg is a slider that a force "
                "<i>F<sub>i</sub></i> pushes along its rail (P), a hinge (R) and a ball joint (S) under the platform. "
                "Twelve coordinates describe it: platform position <i>x, y, z</i> and angles ψ, θ, φ, link angles "
                "α<sub>i</sub>, slider positions <i>s<sub>i</sub></i>. Nine closure equations (the ball joints) leave "
                "three degrees of freedom; <i>y</i> points up."
            ),
            Figure(
                picture,
                "Fig. 1 redrawn by the package's own kinematics. Each rail starts at Aᵢ, where sᵢ = 0, and points to "
                "the centre O; sᵢ is the way of slider Cᵢ along it, αᵢ the elevation of link CᵢBᵢ, P the centre of "
                "the platform. See how the robot stands upright on its hinges, like three coupled inverted pendulums: "
                "that is why it cannot be driven open loop (section on tracking).",
            ),
            Table(
                ("link", ">e", ">β [deg]", ">d", ">Θ [deg]"),
                (("O C₁", "0", "-90", "a − s₁", "90"),),
                "Table 1, the Denavit-Hartenberg row of the paper; legs 2 and 3 are the same, turned by 120 and "
                "−120 degrees about y. The package builds legs from a placement, a prismatic and a revolute joint "
                "instead, which gives the same points Cᵢ and Bᵢ.",
            ),
            Table(
                ("symbol", "meaning", "unit", ">paper (Table 2)", ">here"),
                tuple(rows),
                "Table 2, the parameters. The inertias follow from M and b (uniform disc); links are uniform rods, "
                "sliders massless. The paper calls b the edge of the platform; its equation 25 uses it as the radius.",
            ),
        ),
        (Check.holds("All parameters of Table 2 are the paper's", same, "Table 2"),),
    )


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:g}"
