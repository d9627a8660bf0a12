"""Verification of records: manifests, checks, and replays of runs."""
