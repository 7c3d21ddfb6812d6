"""What looks wrong with a robot description: limits, inertias, meshes, joints that cannot move."""

from ulna.diagnosis.diagnose import diagnose as diagnose
from ulna.diagnosis.diagnose import report as report
from ulna.diagnosis.finding import Finding as Finding
from ulna.diagnosis.repair import repair_inertias as repair_inertias
from ulna.diagnosis.shape_inertias import shape_inertias as shape_inertias
