"""Other tools' symbolic null spaces: SymPy, SymEngine, CasADi, FLINT, each in a process of its own."""

from nullbody.bench.peer.race import Heat, Lap, Race
from nullbody.bench.peer.table import PEERS, Peer

__all__ = ["PEERS", "Heat", "Lap", "Peer", "Race"]
