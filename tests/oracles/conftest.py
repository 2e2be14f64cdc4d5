"""pinocchio has no wheels for Windows: its oracle is collected everywhere else."""

import sys

collect_ignore = ["test_pinocchio.py"] if sys.platform == "win32" else []
