"""Paper tables and pictures recomputed: ours beside what the sources print. Not in the wheel."""
