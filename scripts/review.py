"""The command ``ship-gym review`` of this checkout; see --help."""

from _cli import run_script

run_script("review")
