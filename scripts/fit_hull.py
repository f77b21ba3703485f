"""The command ``ship-gym fit-hull`` of this checkout; see --help."""

from _cli import run_script

run_script("fit-hull")
