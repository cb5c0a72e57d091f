"""Simulated measurements of pneumatic muscles with hidden effects: physics, rig, noise, suite. Plain SI units throughout."""
