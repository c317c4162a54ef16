"""nullbody verify"""

from __future__ import annotations

from typing import Annotated

import typer

from nullbody.cli.options import Independent, Json, MechanismName, Parameters, Values, model_of, names
from nullbody.cli.output import complain, print_json
from nullbody.errors import VerificationError

__all__ = ["EXAMPLES", "verify"]

EXAMPLES = (
    "nullbody verify three_prs",
    "nullbody verify three_prs --engines mujoco --states 10 --set l=0.6,ms=0.2",
    "nullbody verify three_prs --engines multipliers --json",
)

Engines = Annotated[
    Values, typer.Option(metavar="NAME,...", help="mujoco, pinocchio, multipliers. By default the first two.")
]
States = Annotated[int, typer.Option(min=1, metavar="COUNT", help="Number of random admissible states.")]
Seed = Annotated[int, typer.Option(min=0, metavar="NUMBER", help="Of the random states and inputs.")]


def verify(
    mechanism: MechanismName,
    engines: Engines = None,
    states: States = 50,
    seed: Seed = 0,
    parameters: Parameters = None,
    independent: Independent = None,
    as_json: Json = False,
) -> int:
    """Compare a model with independent engines.

    Accelerations, inverse-dynamics forces and reactions are compared in random admissible states. The exit code
    is 1 where an engine disagrees.
    """
    from nullbody.simulate import progress_bar
    from nullbody.verify import compare

    model = model_of(mechanism, independent, parameters)
    chosen = names(engines) or ("mujoco", "pinocchio")
    with progress_bar(f"verifying {mechanism}", 0, states * len(chosen)) as advance:
        found = compare(model, engines=chosen, states=states, seed=seed, progress=lambda done, _: advance(done))
    if as_json:
        print_json(found.to_dict())
    else:
        print(found)
    try:
        found.check()
    except VerificationError as error:
        return complain(error, 1)
    return 0
