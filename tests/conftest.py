"""Byte code is kept while tests run, also where the environment asks for none.

The tests start some hundred processes, and each of them would compile the whole package anew.
"""

import os
import sys

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
