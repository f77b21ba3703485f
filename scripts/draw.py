"""The command ``ship-gym draw`` of this checkout; see --help."""

from _cli import run_script

run_script("draw")
