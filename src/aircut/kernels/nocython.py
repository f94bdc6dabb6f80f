"""Stands in for the `cython` module where there is none: decorators that do nothing."""

compiled = False


def _same(function):
    return function


def boundscheck(_on):
    return _same


wraparound = cdivision = boundscheck
