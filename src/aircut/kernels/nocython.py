"""Stands in for the `cython` module where there is none: decorators that do nothing."""

compiled = False


def cfunc(function):
    return function


def boundscheck(_on):
    return cfunc


wraparound = cdivision = boundscheck
