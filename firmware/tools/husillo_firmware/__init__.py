"""Builds the firmwares, runs them in QEMU, and compares with the host and golden figures."""
