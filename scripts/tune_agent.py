"""The command ``ship-gym tune-agent`` of this checkout; see --help."""

from _cli import run_script

run_script("tune-agent")
