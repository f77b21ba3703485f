"""The command ``ship-gym fmu`` of this checkout; see --help."""

from _cli import run_script

run_script("fmu")
