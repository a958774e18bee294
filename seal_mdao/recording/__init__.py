"""Recorder files that remain complete if a process is killed, and that can be continued."""
