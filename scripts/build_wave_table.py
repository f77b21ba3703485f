"""The command ``ship-gym build-wave-table`` of this checkout; see --help."""

from _cli import run_script

run_script("build-wave-table")
