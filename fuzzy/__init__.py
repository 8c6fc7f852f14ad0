"""Fuzzy inference."""
