"""IEC 61131-7 .fcl: the standard's, jFuzzyLogic's and fuzzylite's dialects."""
