"""The command ``ship-gym linearise`` of this checkout; see --help."""

from _cli import run_script

run_script("linearise")
