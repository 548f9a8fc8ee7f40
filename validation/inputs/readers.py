"""Readers of descriptions, imported once into the process that workers are forked from.

They are imported when they are first used, which in a worker of one model is once a model: a fifth of a second each.
"""

from __future__ import annotations

from .cases import FILES, file_case

for _label, _name in FILES.items():
    if not _name.endswith(".xml"):  # That reader imports an engine, which may not be asked.
        file_case(_label).load()
