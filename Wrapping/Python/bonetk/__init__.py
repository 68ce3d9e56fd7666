"""BoneTK: layered tetrahedral density models of bones from CT.

Points are in mm in the patient's frame LPS; arrays of images are [z, y, x]. ``bonetk.commands`` has the commands of the
program bonetk, from files to files.
"""
from . import commands
from ._bonetk import DataError, Error, UsageError, get_threads, set_threads, version as __version__

__all__ = ["DataError", "Error", "UsageError", "__version__", "commands", "get_threads", "set_threads"]
