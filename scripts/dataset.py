"""The command ``ship-gym dataset`` of this checkout; see --help."""

from _cli import run_script

run_script("dataset")
