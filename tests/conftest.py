"""Lets tests import the helpers beside them, and says how chance is used."""

import os
import sys
from pathlib import Path

from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parent))

# The same examples in every run: what passes here passes everywhere. New ones are sought on purpose:
# AIRCUT_SEARCH=1 python -m pytest tests/test_contact.py
settings.register_profile("same", derandomize=True)
settings.register_profile("search")
settings.load_profile("search" if os.environ.get("AIRCUT_SEARCH") else "same")
