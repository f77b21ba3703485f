"""The command ``ship-gym trials`` of this checkout; see --help."""

from _cli import run_script

run_script("trials")
