"""The commands beside `check`: their modules load engines, so they are imported when one of them is asked for."""

from __future__ import annotations

from symofros.commands.grammar import program

from .campaigns import command as campaign
from .dashboard import command as dashboard
from .dashboard.catalogue import TOPICS
from .reporting.command import add_command
from .truth_data import command as truth

app = program()
for topic in TOPICS.values():
    if topic.name != "check":
        add_command(app, topic)
campaign.register(app)
dashboard.register(app)
truth.register(app)
