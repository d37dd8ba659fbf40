"""Checks of the firmwares: built, run in QEMU, compared with the host and with golden figures."""
