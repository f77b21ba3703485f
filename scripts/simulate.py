"""The command ``ship-gym simulate`` of this checkout; see --help."""

from _cli import run_script

run_script("simulate")
