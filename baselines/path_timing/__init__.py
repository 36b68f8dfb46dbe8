"""Time parameterization along a fixed path."""
