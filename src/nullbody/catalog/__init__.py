"""Layer 4: ready-made mechanisms."""

from nullbody.catalog.three_prs import three_prs

__all__ = ["three_prs"]
