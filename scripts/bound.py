"""The command ``ship-gym bound`` of this checkout; see --help."""

from _cli import run_script

run_script("bound")
