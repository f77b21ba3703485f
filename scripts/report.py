"""The command ``ship-gym report`` of this checkout; see --help."""

from _cli import run_script

run_script("report")
