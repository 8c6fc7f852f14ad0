"""The browser workbench and its command line."""
