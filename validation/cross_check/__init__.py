"""The report of the cross-check: do independent engines agree with the generated code?"""
