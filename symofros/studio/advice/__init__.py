"""No more than a scene needs: the cheapest model that keeps its tolerance (docs/advise.md)."""
