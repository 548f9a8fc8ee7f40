"""What keeps a campaign from being done."""

from __future__ import annotations

from pathlib import Path

from ..program import PROGRAM


class PlanError(ValueError):
    """A plan can't be carried out; says what was found, the rule, and the remedy."""

    def __init__(self, where: str, found: str, rule: str, remedy: str) -> None:
        super().__init__(f"{where}\n  found:  {found}\n  rule:   {rule}\n  remedy: {remedy}")


class StoreError(OSError):
    """A folder can't serve: it is another campaign's, or in use; says what was found, the rule, and the remedy."""

    def __init__(self, folder: Path, found: str, rule: str, remedy: str) -> None:
        super().__init__(f"folder '{folder}'\n  found:  {found}\n  rule:   {rule}\n  remedy: {remedy}")


class ClusterError(OSError):
    """A cluster can't be reached, or has nobody to work; says what was found, the rule, and the remedy."""

    def __init__(self, address: str, found: str, rule: str, remedy: str) -> None:
        super().__init__(f"scheduler '{address}'\n  found:  {found}\n  rule:   {rule}\n  remedy: {remedy}")


class Unfinished(RuntimeError):
    """Batches are missing: the session was interrupted, or some could not be done.

    Args:
        folder: Folder of the campaign.
        reasons: Reasons of the batches that could not be done; none: it was interrupted.
    """

    def __init__(self, folder: Path, reasons: list[str]) -> None:
        what = f"{len(reasons)} batches could not be done" if reasons else "interrupted; what is finished is kept"
        lines = [f"not done: {why}" for why in reasons]
        super().__init__("\n".join([*lines, f"{what}; to go on: {PROGRAM} campaign resume {folder}"]))
        self.interrupted = not reasons
