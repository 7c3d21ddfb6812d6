"""The former place of `FixedAttributes`."""
