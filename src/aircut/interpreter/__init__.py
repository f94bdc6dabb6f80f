"""A program against a machine, giving canonical commands."""
