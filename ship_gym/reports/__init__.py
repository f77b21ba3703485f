"""Reports: what a manoeuvre, a fit or a speed measurement says, as data and as plain text."""
