"""The command ``ship-gym export`` of this checkout; see --help."""

from _cli import run_script

run_script("export")
