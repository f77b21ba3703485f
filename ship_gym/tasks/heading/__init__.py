"""The task `heading_keeping`; light, so that its environment id costs no import of kernels."""

NAME, VERSION = "heading_keeping", 0
