"""Compile the kernels where that is possible; without a compiler their Python twins serve."""

import sys
from pathlib import Path

from setuptools import Extension, setup

KERNELS = sorted(Path("src/aircut/kernels").glob("[!_]*.py"))
# Twins must agree bit for bit, so no fused multiply-add.
FLAGS = [] if sys.platform == "win32" else ["-O3", "-ffp-contract=off", "-fno-math-errno"]


def extensions():
    try:
        from Cython.Build import cythonize
    except ImportError:
        print("warning: no Cython: aircut runs on its Python kernels", file=sys.stderr)
        return []
    modules = [
        Extension(f"aircut.kernels.{path.stem}", [path.as_posix()], extra_compile_args=FLAGS, optional=True)
        for path in KERNELS
        if path.stem != "nocython"
    ]
    modules = cythonize(modules, compiler_directives={"language_level": 3}, quiet=True)
    for module in modules:
        module.optional = True  # cythonize forgets it
    return modules


setup(ext_modules=extensions())
