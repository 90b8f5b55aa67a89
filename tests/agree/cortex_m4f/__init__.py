"""Exported C on a bare Cortex-M4F: built by a cross compiler, run by an emulator, and measured."""
