"""The command ``ship-gym serve`` of this checkout; see --help."""

from _cli import run_script

run_script("serve")
