"""The command ``ship-gym new-ship`` of this checkout; see --help."""

from _cli import run_script

run_script("new-ship")
