"""The task `track_following`; light, so that its environment id costs no import of kernels."""

NAME, VERSION = "track_following", 0
