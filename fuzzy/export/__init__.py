"""Controllers for elsewhere: C99 and Python code, tables, a JSON Schema, a python-control system."""
