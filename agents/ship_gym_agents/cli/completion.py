"""``ship-gym completion``."""

from __future__ import annotations

import click

from ship_gym_agents.cli.options import verb

_NOTES = """
to install it, once:
  bash   ship-gym completion bash > ~/.local/share/bash-completion/completions/ship-gym
  zsh    ship-gym completion zsh > ~/.zfunc/_ship-gym    # in ~/.zshrc, before compinit:
                                                         # fpath+=~/.zfunc
  fish   ship-gym completion fish > ~/.config/fish/completions/ship-gym.fish
"""


@verb("bash", "zsh > ~/.zfunc/_ship-gym", notes=_NOTES)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def command(as_json, shell) -> None:
    """Print the script that completes ship-gym in a shell."""
    from click.shell_completion import get_completion_class

    from ship_gym_agents.cli import PROGRAM, ship_gym
    from ship_gym_agents.cli.output import show

    complete = get_completion_class(shell)(ship_gym, {}, PROGRAM, "_SHIP_GYM_COMPLETE")
    script = complete.source()
    show(as_json, {"shell": shell, "script": script}, script.strip())
