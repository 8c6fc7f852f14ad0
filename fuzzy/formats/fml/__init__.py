"""IEEE 1855-2016 FML .xml."""
