"""Checks the firmwares: builds them, runs them in QEMU, compares with host and golden figures."""
