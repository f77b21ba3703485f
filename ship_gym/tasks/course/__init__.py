"""The task `course_changing`; light, so that its environment id costs no import of kernels."""

NAME, VERSION = "course_changing", 0
