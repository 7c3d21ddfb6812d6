"""The former name of `ulna.compiler.language.lanes`, kept so that existing programs run."""

from ulna.compiler.language.lanes import choose as choose
from ulna.compiler.language.lanes import in_any_lane as in_any_lane
from ulna.compiler.language.lanes import lane as lane
from ulna.compiler.language.lanes import least as least
