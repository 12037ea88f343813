"""What tests hand on to the hundreds of processes that they start.

Byte code is kept, also where the environment asks for none: each process would compile the whole
package anew. Ctrl-C is heard: a job in the background of a shell hands on that it is ignored.
"""

import os
import signal
import sys

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
