"""The former name of `ulna.compiler.forms.lanes`, kept so that existing programs run."""

from ulna.compiler.forms.lanes import choose as choose
from ulna.compiler.forms.lanes import in_any_lane as in_any_lane
from ulna.compiler.forms.lanes import lane as lane
from ulna.compiler.forms.lanes import least as least
