"""LinuxCNC's RS274/NGC language: its reader, its flow, its codes.

What it does was learnt from its documentation and by running its own stand-alone
interpreter (the package linuxcnc-uspace); where the two differ, the program is followed.
"""
