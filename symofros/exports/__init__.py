"""Other people's formats: C package, MEX, S-function, FMU 2.0 and 3.0, URDF, MJCF; each a thin wrapper, none with equations."""
