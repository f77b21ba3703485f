"""Numbers of a ship from tests of her: captive runs, and records of a free-running ship."""
