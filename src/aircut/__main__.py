"""`python -m aircut` is the command `aircut`."""

from aircut.cli import main

main()
