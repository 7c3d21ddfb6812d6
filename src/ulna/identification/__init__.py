"""Finding the masses, inertias and friction of a robot from what it did: logged positions and torques."""

from ulna.identification.blocks import LogFit as LogFit
from ulna.identification.convex import Progress as Progress
from ulna.identification.fit import identify as identify
from ulna.identification.identifiable_parameters import BaseParameters as BaseParameters
from ulna.identification.identifiable_parameters import base_parameters as base_parameters
from ulna.identification.identifiable_parameters import base_parameters_of as base_parameters_of
from ulna.identification.physical import from_log_cholesky as from_log_cholesky
from ulna.identification.physical import log_cholesky as log_cholesky
from ulna.identification.physical import nearest_physical as nearest_physical
from ulna.identification.result import Identification as Identification
