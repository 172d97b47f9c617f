"""`rsym models`: the models that come with rsym, a line each."""

from __future__ import annotations

import argparse

from rsym.commands.options import Commands, add_command

GROUP = "models"


def add(commands: Commands) -> None:
    """Describe the command."""
    add_command(commands, "models", "list the models that come with rsym, a line each", "rsym models", run)


def run(options: argparse.Namespace) -> None:
    """Print the table."""
    from rsym.commands.letters import aligned
    from rsym.paper.models import MODELS, model_title

    print(aligned([("model", "what it is"), *((name, model_title(name)) for name in MODELS)]))
