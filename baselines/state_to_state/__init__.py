"""Chains of minimum-time moves between states, by Ruckig."""
