"""`Chart`: where the simulator's north and east [m] lie on the earth.

A ship's motion knows no place, only north. So the plane is local and goes with the route: each leg
is laid down with its true bearing and length, one behind the other. Along the route headings,
lengths and distances from it are those on the earth; only the last way-point of a route that goes
round in a ring does not come back to the first.
"""
