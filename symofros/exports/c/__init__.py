"""Packages of C: one model, a diagram, Matlab and Octave, Simulink."""
