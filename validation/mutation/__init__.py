"""Faults planted in our own source, one at a time: does `check` see them, do the tests?"""
