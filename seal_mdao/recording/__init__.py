"""Recorder files that survive a kill and can be continued."""
