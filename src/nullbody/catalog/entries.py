"""The entries of the catalog, in the order in which people read them: robots, linkages, published benchmarks."""

from __future__ import annotations

from math import cos, pi, sin

from nullbody.catalog.entry import Entry

__all__ = ["ENTRIES"]

_TILT = pi / 9  # of the rolling disc in its picture

_ROBOTS = (
    Entry(
        "three_prs",
        "3-PRS parallel robot",
        "robot",
        "Three sliders on horizontal rails, each with a link on a hinge, carry a platform on spherical joints.",
        3,
        "7 bodies with 12 coordinates, 9 independent equations of three spherical joints",
        "a paper of 2020, which theory.md restates and paper.md checks",
        task=("y", "psi", "phi"),
    ),
    Entry(
        "three_prs_vertical",
        "3-PRS with vertical rails",
        "robot",
        "Three sliders on vertical columns at 120 degrees, each with a link on a hinge, lift and tilt one plate.",
        3,
        "7 bodies with 12 coordinates, 9 independent equations of three spherical joints",
        "J. A. Carretero, R. P. Podhorodeski, M. A. Nahon, C. M. Gosselin, J. Mech. Design 122 (2000) 17-24",
        task=("y", "psi", "phi"),
        pose={"s1": 0.25, "s2": 0.32, "s3": 0.3},
    ),
    Entry(
        "three_rps",
        "3-RPS parallel robot",
        "robot",
        "Three telescopic legs, hinged on the ground, carry a platform on spherical joints.",
        3,
        "7 bodies with 12 coordinates, 9 independent equations of three spherical joints",
        "K.-M. Lee, D. K. Shah, IEEE J. Robotics Automation 4 (1988) 354-360",
        task=("z", "psi", "theta"),
        pose={"s1": 0.52, "s2": 0.44, "s3": 0.42},
    ),
    Entry(
        "stewart_platform",
        "Stewart platform (Gough-Stewart, 6-UPS)",
        "robot",
        "Six telescopic legs in universal joints carry a platform on spherical joints and move it in all six ways.",
        6,
        "13 bodies with 24 coordinates, 18 independent equations of six spherical joints",
        "V. E. Gough, S. G. Whitehall, Proc. 9th FISITA Congress (1962) 117-137; D. Stewart, Proc. Inst. Mech. Eng. "
        "180 (1965) 371-386",
        task=("x", "y", "z", "psi", "theta", "phi"),
    ),
    Entry(
        "delta",
        "Delta robot",
        "robot",
        "Three driven arms with parallelogram forearms, here rods between universal joints, move a platform that never "
        "turns.",
        3,
        "7 bodies with 15 coordinates, 12 independent equations of three universal joints: nine keep the loops closed, "
        "three keep the platform from turning",
        "R. Clavel, Proc. Int. Symp. on Industrial Robots (1988) 91-100; L.-W. Tsai, R. Stamper, ASME DETC96-MECH-1169 "
        "(1996)",
        task=("x", "y", "z"),
    ),
    Entry(
        "five_bar",
        "Planar five-bar robot (5R)",
        "robot",
        "Two driven cranks carry a tool between their couplers.",
        2,
        "4 bodies with 6 coordinates, 4 independent equations of two pins; the two across the plane are 0 = 0",
        "X.-J. Liu, J. Wang, G. Pritschow, Mechanism and Machine Theory 41 (2006) 145-169",
        task=("x", "y"),
    ),
    Entry(
        "three_rrr",
        "Planar 3-RRR robot",
        "robot",
        "Three driven cranks with couplers move and turn a platform in its plane.",
        3,
        "7 bodies with 9 coordinates, 6 independent equations of three pins; the three across the plane are 0 = 0",
        "C. Gosselin, J. Angeles, J. Mech. Trans. Autom. Design 110 (1988) 35-41",
        task=("x", "y", "phi"),
        pose={"x": 0.02, "y": 0.01, "phi": 0.2},
    ),
)

_LINKAGES = (
    Entry(
        "four_bar",
        "Planar four-bar",
        "linkage",
        "Crank, coupler and rocker on a base.",
        1,
        "3 bodies with 3 coordinates, 2 independent equations of one pin; the one across the plane is 0 = 0",
        "MBDE toolbox, Universities of A Coruna and Almeria",
        task=("theta3",),
    ),
    Entry(
        "slider_crank",
        "Planar slider-crank",
        "linkage",
        "Crank, rod, and a slider on a rail that may miss the shaft.",
        1,
        "3 bodies with 3 coordinates, 2 independent equations of one pin; the one across the plane is 0 = 0",
        "R. S. Hartenberg, J. Denavit, Kinematic Synthesis of Linkages (1964)",
        task=("s",),
    ),
    Entry(
        "spatial_slider_crank",
        "Spatial slider-crank (RSUP)",
        "linkage",
        "A crank that turns in a plane across the rail; the rod has a ball on the crank and a universal joint on the "
        "slider.",
        1,
        "3 bodies with 4 coordinates, 3 independent equations of one spherical joint; with a ball at both ends (RSSP) "
        "the rod could also spin about itself",
        "E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 12.2",
        task=("s",),
        pose={"theta": -0.6},
        view=(40.0, 22.0),
    ),
    Entry(
        "rssr",
        "Spatial four-bar (RSSR)",
        "linkage",
        "A crank and a rocker on skew axes, joined by a coupler; the ball on the crank is a universal joint.",
        1,
        "3 bodies with 4 coordinates, 3 independent equations of one spherical joint; with a ball at both ends the "
        "coupler could also spin about itself",
        "R. S. Hartenberg, J. Denavit, Kinematic Synthesis of Linkages (1964), chapter 12",
        task=("psi",),
    ),
)

_BENCHMARKS = (
    Entry(
        "a01_pendulum",
        "Pendulum in Cartesian coordinates (A01)",
        "benchmark",
        "A point mass on a massless bar, described by x and y.",
        1,
        "2 coordinates, 1 equation of constant distance",
        "IFToMM library of computational benchmark problems, A01",
        pose={"x": -0.6, "y": -0.8},
    ),
    Entry(
        "n_four_bar",
        "N four-bars in a row (A02)",
        "benchmark",
        "Parallel bars whose tops are joined by couplers; lying flat, N + 1 motions are possible at once.",
        1,
        "2 N + 1 bodies with as many coordinates, 2 independent equations in each of N loops",
        "IFToMM library of computational benchmark problems, A02",
        arguments={"n": 3},
        pose={"theta0": 0.5},
    ),
    Entry(
        "andrews",
        "Andrews' squeezing mechanism (A03)",
        "benchmark",
        "Seven bodies in the plane, three loops through one point, a stiff spring and a motor of constant torque.",
        1,
        "7 bodies with 7 coordinates, 6 independent equations of three pins; the three across the plane are 0 = 0",
        "Test Set for IVP Solvers, release 2.4, section II-13; W. Schiehlen (ed.), Multibody Systems Handbook (1990)",
    ),
    Entry(
        "bricard",
        "Bricard's mechanism (A04)",
        "benchmark",
        "Six bars of a cube's edges, one of them the ground, joined by six revolutes.",
        1,
        "5 bodies with 5 coordinates, 5 equations of one revolute, of which 4 are independent wherever the loop is "
        "closed: counting alone gives 0",
        "IFToMM library of computational benchmark problems, A04",
        pose={"theta1": 0.4},
    ),
    Entry(
        "flyball_governor",
        "Stiff flyball governor (A05)",
        "benchmark",
        "Two heavy arms on a turning shaft, held by stiff spring-dampers on a slider.",
        4,
        "6 bodies with 4 coordinates, no loop",
        "IFToMM library of computational benchmark problems, A05",
    ),
    Entry(
        "chaplygin_sleigh",
        "Chaplygin sleigh",
        "benchmark",
        "A rigid body on a plane that stands on one blade.",
        2,
        "3 coordinates, 1 nonholonomic equation of the blade: 2 rates, 3 coordinates that can be reached",
        "A. M. Bloch, Nonholonomic Mechanics and Control (2015), section 1.7",
        pose={"phi": 0.4},
    ),
    Entry(
        "rolling_disc",
        "Rolling disc",
        "benchmark",
        "A thin disc that rolls without slip on a horizontal plane: Euler's disc, the falling coin.",
        3,
        "7 coordinates, the norm of the Euler parameters, the height of the rim and 2 nonholonomic equations of slip: "
        "3 rates, 5 coordinates that can be reached",
        "cases of EXUDYN and PyDy; J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems (1972)",
        pose={"x": 0.5 * sin(_TILT), "z": 0.5 * cos(_TILT), "e0": cos(_TILT / 2), "e2": sin(_TILT / 2)},
        view=(40.0, 22.0),
    ),
)

#: Every mechanism of the catalog by name.
ENTRIES: dict[str, Entry] = {entry.name: entry for entry in (*_ROBOTS, *_LINKAGES, *_BENCHMARKS)}
