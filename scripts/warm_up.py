"""The command ``ship-gym warm-up`` of this checkout; see --help."""

from _cli import run_script

run_script("warm-up")
