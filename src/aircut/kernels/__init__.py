"""The compiled loops.

Each module is Python that Cython compiles; the uncompiled file is its own twin
and serves where there was no compiler, or where the environment variable
AIRCUT_PYTHON_KERNELS is set. Kernels know bytes and numbers, nothing of dialects
or machines.
"""

import os
import sys
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from types import ModuleType


def twin(name: str, as_name: str) -> ModuleType:
    """The uncompiled kernel of this name, loaded as a module of another."""
    path = Path(__file__).with_name(f"{name}.py")
    spec = spec_from_loader(as_name, SourceFileLoader(as_name, str(path)))
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[as_name] = module
    spec.loader.exec_module(module)
    return module


if os.environ.get("AIRCUT_PYTHON_KERNELS"):
    scan = twin("scan", "aircut.kernels.scan")
    plain = twin("plain", "aircut.kernels.plain")
    holes = twin("holes", "aircut.kernels.holes")
    bounds = twin("bounds", "aircut.kernels.bounds")
    mesh = twin("mesh", "aircut.kernels.mesh")
    pieces = twin("pieces", "aircut.kernels.pieces")
    lookahead = twin("lookahead", "aircut.kernels.lookahead")
    thin = twin("thin", "aircut.kernels.thin")
    follow = twin("follow", "aircut.kernels.follow")
    beside = twin("beside", "aircut.kernels.beside")
    printing = twin("printing", "aircut.kernels.printing")
    scurve = twin("scurve", "aircut.kernels.scurve")
    angles = twin("angles", "aircut.kernels.angles")
