"""The former name of `support.compat_packages`, for tests that are being written."""

from support.compat_packages import using as worn

__all__ = ["worn"]
