"""Tests of the page in a real browser: a package, so that the browser which they share is gone before other tests."""
