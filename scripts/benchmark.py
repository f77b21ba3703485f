"""The command ``ship-gym benchmark`` of this checkout; see --help."""

from _cli import run_script

run_script("benchmark")
