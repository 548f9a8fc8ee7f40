"""Other people's formats: C package, MEX, S-function, FMU, URDF, MJCF: wrappers, none with equations."""
