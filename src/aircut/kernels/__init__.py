"""The compiled loops.

Each module is Python that Cython compiles; the uncompiled file is its own twin
and serves where there was no compiler. Kernels know bytes and numbers, nothing
of dialects or machines.
"""
