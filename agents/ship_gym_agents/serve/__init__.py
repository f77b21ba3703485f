"""A ship on NMEA 0183: an autopilot of flesh, of steel or of another program steers her.

``nmea`` makes and reads sentences, ``orders`` says what one orders, ``instruments`` what the
instruments of the ship show, ``talk`` the sentences of that; ``vessel`` is the ship, ``voyage`` her
route, ``binding`` where sockets listen, ``ports`` who is on them, ``server`` the loop over time.
docs/autopilot_loop.md.
"""
