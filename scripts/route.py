"""The command ``ship-gym route`` of this checkout; see --help."""

from _cli import run_script

run_script("route")
