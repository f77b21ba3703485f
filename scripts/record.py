"""The command ``ship-gym record`` of this checkout; see --help."""

from _cli import run_script

run_script("record")
