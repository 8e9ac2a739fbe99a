"""The project against its alternatives, and against the clock; README.md tells how to run each."""
