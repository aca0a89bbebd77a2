"""Imported last by the process whose copies the workers are: what is loaded by then is no rubbish.

Python would look through all of it for rubbish again and again, which takes a worker some hundredths of its time.
"""

import gc

gc.freeze()
