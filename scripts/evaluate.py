"""The command ``ship-gym evaluate`` of this checkout; see --help."""

from _cli import run_script

run_script("evaluate")
