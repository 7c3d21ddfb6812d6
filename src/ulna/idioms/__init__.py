"""What names of other libraries are called here, for messages that say what to use instead."""

from ulna.idioms.explain import IDIOMS as IDIOMS
from ulna.idioms.explain import Explained as Explained
from ulna.idioms.explain import check_keywords as check_keywords
from ulna.idioms.explain import explained as explained
from ulna.idioms.explain import unknown_attribute as unknown_attribute
