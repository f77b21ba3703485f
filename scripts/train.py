"""The command ``ship-gym train`` of this checkout; see --help."""

from _cli import run_script

run_script("train")
