"""fuzzylite's .fll."""
