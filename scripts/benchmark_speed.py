"""The command ``ship-gym speed`` of this checkout; see --help."""

from _cli import run_script

run_script("speed")
