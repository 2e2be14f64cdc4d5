"""Scans of a freeform face made rows of a run.

In: points of a scan on a machine, the standard, the probe. Out: a `Run` of means that are as good
as independent, the set-up fitted, and the noise that the scan shows.
"""

from matstd.probe_paths.scans.evaluation import STRETCH as STRETCH
from matstd.probe_paths.scans.evaluation import ScanNoise as ScanNoise
from matstd.probe_paths.scans.evaluation import ScanPoints as ScanPoints
from matstd.probe_paths.scans.evaluation import evaluate_scan as evaluate_scan
