"""Writing of the pages under docs/environments from what the code says. Not in the wheel."""
