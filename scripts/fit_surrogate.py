"""The command ``ship-gym fit-surrogate`` of this checkout; see --help."""

from _cli import run_script

run_script("fit-surrogate")
