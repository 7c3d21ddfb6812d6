"""What tests share: random models, converters from the oracles' models, numerical derivatives."""
