"""MATLAB's and Octave's .fis, and what fuzzylite writes under this suffix."""
